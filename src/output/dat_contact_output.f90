!> The tables of CONTACT PRINT and SECTION PRINT in job.dat.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Titles, signs and columns are those of CalculiX.
module amontons_dat_contact_output
  use amontons_kinds, only: DP
  use amontons_text, only: upper_case
  use amontons_tensor, only: cross_product
  use amontons_element_kinds, only: has_faces_in_space
  use amontons_postprocess, only: integrate_section, pair_sums_type, section_type, sector_share, printed_contact_energy, &
    printed_slip, sum_pair_forces
  use amontons_steps, only: print_request_type
  use amontons_model, only: model_type, absent_elements, DIALECT_CALCULIX
  use amontons_state, only: fields_type, slave_state_type, STATUS_OPEN
  implicit none
  private
  public :: print_contact_variable, print_section_sums, block_name, contact_axes
  public :: NODE_FORMAT, TOTAL_FORMAT

  character(*), parameter :: NODE_FORMAT = '(i10,1p,3(1x,e13.6))'
  character(*), parameter :: FACE_FORMAT = '(i10,1x,i10,1p,8(1x,e13.6))'     !< a row of a point of an element's face
  character(*), parameter :: TOTAL_FORMAT = '(6x,1p,3(1x,e13.6))'
  character(*), parameter :: STATISTICS_FORMAT = '(2x,1p,6(1x,e13.6))'

contains

  !> CDIS, CSTR, CELS of the closed slave nodes or points of slave faces, their number CNUM, SCEN (own), and the statistics CF, CFN,
  !! CFS of each pair.
  !!
  !! As in CalculiX pressure is positive, a negative gap is penetration, and the tangential components are slip and the
  !! shear stress that goes with it (that on the master, in the direction of slip of the slave).
  subroutine print_contact_variable(unit, model, fields, request, variable)
    integer, intent(in) :: unit
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(print_request_type), intent(in) :: request
    character(*), intent(in) :: variable
    type(slave_state_type), allocatable :: slaves(:)
    character(:), allocatable :: label
    real(DP) :: share                              ! of the circle
    integer :: i
    slaves = chosen_slaves(model, fields%slaves, request)
    share = sector_share(model)
    label = 'slave node'
    if (any(slaves%slave_facet > 0)) label = 'slave element+face'
    select case (variable)
    case ('CDIS')
      call print_contact_head(unit, 'relative contact displacement (' // label // ',normal,tang1,tang2)', fields%total_time)
      call print_slave_rows(unit, model, slaves, is_stress=.false.)
    case ('CSTR')
      call print_contact_head(unit, 'contact stress (' // label // ',press,tang1,tang2)', fields%total_time)
      call print_slave_rows(unit, model, slaves, is_stress=.true.)
    case ('SCEN')
      call print_contact_head(unit, 'slip scenario (slave node,status,scenario)', fields%total_time)
      do i = 1, size(slaves)
        associate (slave => slaves(i))
          if (slave%status == STATUS_OPEN .and. slave%scenario == 0) cycle
          write (unit, '(i10,2(1x,i10))') model%mesh%node_label(slave%node), slave%status, slave%scenario
        end associate
      end do
    case ('CELS')
      call print_contact_head(unit, 'contact spring energy (' // label // ',energy)', fields%total_time)
      do i = 1, size(slaves)
        if (slaves(i)%status /= STATUS_OPEN) call print_slave(unit, model, slaves(i), [share * printed_contact_energy(model, &
          slaves(i))])
      end do
      if (.not. (request%is_totals .or. request%is_only_totals)) return
      write (unit, '(/a,e14.7/)') ' total contact spring energy for time ', fields%total_time
      write (unit, TOTAL_FORMAT) share * sum([(printed_contact_energy(model, slaves(i)), i=1, size(slaves))])
    case ('CNUM')
      write (unit, '(/a,e14.7/)') ' total number of contact elements for time ', fields%total_time
      write (unit, '(6x,1x,i10)') count(slaves%status /= STATUS_OPEN)
    case default
      do i = 1, size(model%pairs)
        if (.not. is_chosen_pair(model, request, i)) cycle
        call print_statistics(unit, model, fields, pack(slaves, slaves%pair == i), i, variable)
      end do
    end select
  end subroutine print_contact_variable


  !> The block that contains a sum over a pair: Abaqus has a name for each part of it.
  elemental function block_name(variable) result(name)
    character(*), intent(in) :: variable
    character(4) :: name
    select case (variable)
    case ('CFN', 'CMN', 'XN')
      name = 'CFN'
    case ('CFS', 'CMS', 'XS')
      name = 'CFS'
    case ('CF', 'CFT', 'CMT', 'XT', 'CARE')
      name = 'CF'
    case default
      name = variable
    end select
  end function block_name


  !> Whether a CONTACT PRINT selects a pair.
  pure logical function is_chosen_pair(model, request, pair) result(is_chosen)
    type(model_type), intent(in) :: model
    type(print_request_type), intent(in) :: request
    integer, intent(in) :: pair
    is_chosen = (request%slave == 0 .or. request%slave == model%pairs(pair)%slave) .and. &
      (request%master == 0 .or. request%master == model%pairs(pair)%master)
  end function is_chosen_pair


  !> The slave nodes that a CONTACT PRINT selects.
  pure function chosen_slaves(model, slaves, request) result(chosen)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slaves(:)
    type(print_request_type), intent(in) :: request
    type(slave_state_type), allocatable :: chosen(:)
    logical, allocatable :: is_wanted(:)           ! (n_nodes)
    integer :: s
    allocate (is_wanted(model%mesh%n_nodes), source=request%set == 0)
    if (request%set > 0) is_wanted(model%mesh%node_sets(request%set)%members) = .true.
    chosen = pack(slaves, [(is_chosen_pair(model, request, slaves(s)%pair) .and. is_wanted(slaves(s)%node), &
      s=1, size(slaves))])
  end function chosen_slaves


  !> Rows of the closed slave nodes: gap and slip, or pressure and shear stress, in the axes of contact_axes.
  subroutine print_slave_rows(unit, model, slaves, is_stress)
    integer, intent(in) :: unit
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slaves(:)
    logical, intent(in) :: is_stress
    real(DP) :: axes(3, 3), row(3)
    integer :: i
    do i = 1, size(slaves)
      associate (slave => slaves(i))
        if (slave%status == STATUS_OPEN) cycle
        axes = contact_axes(slave%normal)
        if (is_stress) then
          row = matmul(slave%force - slave%shear, axes)
          if (slave%area > 0) row = row / slave%area
        else
          row = matmul(printed_slip(model, slave), axes)
          row(1) = slave%gap
        end if
        call print_slave(unit, model, slave, row)
      end associate
    end do
  end subroutine print_slave_rows


  !> Row of a slave node with its label, of a point with those of its element and face. CalculiX expands plane elements into
  !! solids, whose faces 3 to 6 are their edges.
  subroutine print_slave(unit, model, slave, values)
    integer, intent(in) :: unit
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slave
    real(DP), intent(in) :: values(:)
    integer :: face
    if (slave%slave_facet == 0) then
      write (unit, NODE_FORMAT) model%mesh%node_label(slave%node), values
      return
    end if
    associate (surface => model%surfaces(model%pairs(slave%pair)%slave))
      face = surface%face(slave%slave_facet)
      if (.not. has_faces_in_space(model%mesh%kind(surface%element(slave%slave_facet)))) face = face + 2
      write (unit, FACE_FORMAT) model%mesh%element_label(surface%element(slave%slave_facet)), face, values
    end associate
  end subroutine print_slave


  !> The normal and two tangents as in CalculiX: the x axis projected on the tangent plane (the z axis if the
  !! normal is along x), and n x t1.
  pure function contact_axes(normal) result(axes)
    real(DP), intent(in) :: normal(3)              !< unit normal out of the master
    real(DP) :: axes(3, 3)                         !< columns n, t1, t2
    real(DP) :: t(3)
    integer :: k
    k = merge(3, 1, 1 - abs(normal(1)) < 1.5231e-6_DP)
    t = -normal(k) * normal
    t(k) = t(k) + 1
    t = t / norm2(t)
    axes(:, 1) = normal
    axes(:, 2) = t
    axes(:, 3) = cross_product(normal, t)
  end function contact_axes


  !> Force, moment, area and mean normal of the slave side of one pair; under the abaqus dialect also the centre of force.
  subroutine print_statistics(unit, model, fields, slaves, i_pair, variable)
    integer, intent(in) :: unit
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(slave_state_type), intent(in) :: slaves(:)      !< of the pair
    integer, intent(in) :: i_pair
    character(*), intent(in) :: variable           !< CF all forces, CFN the normal ones, CFS the tangential ones
    character(:), allocatable :: part
    type(pair_sums_type) :: sums
    real(DP) :: normal_force, force(3), counts(2)
    integer :: k                                   ! column of the centre of force
    part = ''
    counts = 1
    k = 3
    if (variable == 'CFN') then
      part = 'normal '
      counts(2) = 0
      k = 1
    else if (variable == 'CFS') then
      part = 'shear '
      counts(1) = 0
      k = 2
    end if
    call sum_pair_forces(model, fields%u, slaves, sums)
    counts = sector_share(model) * counts
    sums%area = sector_share(model) * sums%area
    force = matmul(sums%force, counts)
    associate (pair => model%pairs(i_pair))
      write (unit, '(//5a,e14.7)') ' statistics for slave set ', upper_case(model%surfaces(pair%slave)%name), &
        ', master set ', upper_case(model%surfaces(pair%master)%name), ' and time ', fields%total_time
    end associate
    call print_sums(unit, 'total ' // part // 'surface force', section_type(force, matmul(sums%moment, counts), sums%center, &
      sums%normal, sums%area))
    normal_force = dot_product(force, sums%normal)
    write (unit, '(/a/)') '   area,  normal force (+ = tension) and shear force (size)'
    write (unit, STATISTICS_FORMAT) sums%area, normal_force, norm2(force - normal_force * sums%normal)
    if (model%dialect == DIALECT_CALCULIX) return
    write (unit, '(/a/)') '   center of the ' // part // 'force'
    write (unit, STATISTICS_FORMAT) sums%place(:, k)
  end subroutine print_statistics


  !> Prints force, moment, centre and normal of a surface, for contact pairs and sections.
  subroutine print_sums(unit, title, s)
    integer, intent(in) :: unit
    character(*), intent(in) :: title
    type(section_type), intent(in) :: s
    write (unit, '(/3a/)') '   ', title, ' (fx,fy,fz) and moment about the origin (mx,my,mz)'
    write (unit, STATISTICS_FORMAT) s%force, s%moment
    write (unit, '(/a/)') '   center of gravity and mean normal'
    write (unit, STATISTICS_FORMAT) s%center, s%normal
    write (unit, '(/a/)') '   moment about the center of gravity(mx,my,mz)'
    write (unit, STATISTICS_FORMAT) s%moment - cross_product(s%center, s%force)
  end subroutine print_sums


  !> SECTION PRINT: the sums over a surface.
  subroutine print_section_sums(unit, model, fields, surface, is_nlgeom)
    integer, intent(in) :: unit
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    integer, intent(in) :: surface                 !< index
    logical, intent(in) :: is_nlgeom
    type(section_type) :: s
    real(DP) :: tension, torque, moment(3)
    call integrate_section(model%mesh, absent_elements(model, fields%step), model%surfaces(surface), fields, is_nlgeom, &
      model%dialect == DIALECT_CALCULIX, s)
    write (unit, '(//3a,e14.7)') ' statistics for surface set ', upper_case(model%surfaces(surface)%name), ' and time ', &
      fields%total_time
    call print_sums(unit, 'total surface force', s)
    moment = s%moment - cross_product(s%center, s%force)
    tension = dot_product(s%force, s%normal)
    torque = dot_product(moment, s%normal)
    write (unit, '(/a/)') '   area, normal force (+ = tension), shear force (size), torque and bending moment (size)'
    write (unit, STATISTICS_FORMAT) s%area, tension, norm2(s%force - tension * s%normal), torque, norm2(moment - torque &
      * s%normal)
  end subroutine print_section_sums


  !> The head line of a block of slave nodes, with blank lines around it.
  subroutine print_contact_head(unit, title, time)
    integer, intent(in) :: unit
    character(*), intent(in) :: title
    real(DP), intent(in) :: time                   !< total time [time]
    write (unit, '(/3a,e14.7/)') ' ', title, ' for all contact elements and time', time
  end subroutine print_contact_head

end module amontons_dat_contact_output
