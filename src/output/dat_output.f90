!> The file job.dat: tables of NODE PRINT and EL PRINT, and dispatch to those of CONTACT PRINT and SECTION PRINT.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Titles and columns are those of CalculiX. RF depends on the dialect: under calculix the block `forces` contains all external
!! forces on a node (supports, loads), under abaqus only the reactions of supports. Under calculix a composite shell is one element,
!! whose points count through its layers from the bottom.
module amontons_dat_output
  use amontons_kinds, only: DP
  use amontons_beam_rules, only: MAX_PRINTED_POINTS
  use amontons_text, only: upper_case
  use amontons_tensor, only: pack_voigt, unpack_voigt
  use amontons_element_kinds, only: MAX_ELEMENT_POINTS, is_cohesive
  use amontons_postprocess, only: find_printed_points, mechanical_strain, integration_point_positions, integration_point_volumes, &
    sector_share, printed_energy_density, damage_variables, convert_to_sector, rotate_truss_tensors
  use amontons_mesh, only: mesh_type, set_type
  use amontons_steps, only: print_request_type, PRINT_CONTACT, PRINT_ELEMENT, PRINT_NODE, PRINT_SECTION
  use amontons_materials, only: HISTORY_CEEQ
  use amontons_model, only: model_type, is_out, absent_elements, DIALECT_CALCULIX
  use amontons_state, only: history_variable, equivalent_plastic_strain, state_variables, n_state_variables, fields_type
  use amontons_section_forces, only: find_section_forces, find_node_rotations, N_SECTION_FORCES
  use amontons_dat_contact_output, only: print_contact_variable, print_section_sums, block_name, NODE_FORMAT, TOTAL_FORMAT
  implicit none
  private
  public :: print_request, printed_forces, in_transform, in_orientation

  character(*), parameter :: POINT_FORMAT = '(i10,1x,i3,1p,*(1x,e13.6))'
  character(*), parameter :: ELEMENT_FORMAT = '(i10,1p,*(1x,e13.6))'

contains

  !> One PRINT card: a block per variable. The deck reader has rejected unknown variables.
  subroutine print_request(unit, model, fields, request, is_nlgeom)
    integer, intent(in) :: unit
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(print_request_type), intent(in) :: request
    logical, intent(in) :: is_nlgeom               !< of the step
    integer :: i
    if (request%kind == PRINT_SECTION) then
      call print_section_sums(unit, model, fields, request%set, is_nlgeom)
      return
    end if
    do i = 1, size(request%variables)
      select case (request%kind)
      case (PRINT_NODE)
        call print_node_variable(unit, model, fields, request, request%variables(i), is_nlgeom)
      case (PRINT_ELEMENT)
        call print_element_variable(unit, model, fields, request, request%variables(i), is_nlgeom)
      case (PRINT_CONTACT)
        if (any(block_name(request%variables(:i - 1)) == block_name(request%variables(i)))) cycle
        call print_contact_variable(unit, model, fields, request, block_name(request%variables(i)))
      end select
    end do
  end subroutine print_request


  !> The set of a request; without one all nodes or elements.
  pure function set_of(mesh, request) result(set)
    type(mesh_type), intent(in) :: mesh
    type(print_request_type), intent(in) :: request
    type(set_type) :: set
    integer :: i
    if (request%set == 0) then
      set%name = 'ALL'
      set%members = [(i, i=1, merge(mesh%n_nodes, mesh%n_elements, request%kind == PRINT_NODE))]
    else if (request%kind == PRINT_NODE) then
      set = mesh%node_sets(request%set)
    else
      set = mesh%element_sets(request%set)
    end if
  end function set_of


  !> U, UR, RF, NT, COORD of a node set.
  subroutine print_node_variable(unit, model, fields, request, variable, is_nlgeom)
    integer, intent(in) :: unit
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(print_request_type), intent(in) :: request
    character(*), intent(in) :: variable
    logical, intent(in) :: is_nlgeom
    type(set_type) :: set
    real(DP), allocatable :: force(:, :), rotation(:, :)
    set = set_of(model%mesh, request)
    select case (variable)
    case ('U')
      call print_node_rows(unit, 'displacements (vx,vy,vz)', model%mesh, set, fields, &
        in_transform(model, fields%u, request%is_local))
    case ('UR')
      allocate (rotation(3, model%mesh%n_nodes))
      call find_node_rotations(model, fields, rotation)
      call print_node_rows(unit, 'rotations (rx,ry,rz)', model%mesh, set, fields, in_transform(model, rotation, request%is_local))
    case ('V')
      call print_node_rows(unit, 'velocities (vx,vy,vz)', model%mesh, set, fields, &
        in_transform(model, fields%v, request%is_local))
    case ('RF')
      force = in_transform(model, printed_forces(model, fields), request%is_local)
      if (.not. request%is_only_totals) &
        call print_node_rows(unit, 'forces (fx,fy,fz)', model%mesh, set, fields, force)
      if (.not. (request%is_totals .or. request%is_only_totals)) return
      call print_head(unit, 'total force (fx,fy,fz)', set, fields%total_time)
      force = printed_forces(model, fields)        ! a sum has no local directions
      write (unit, TOTAL_FORMAT) sum(force(:, set%members), 2)
    case ('NT')
      call print_node_rows(unit, 'temperatures', model%mesh, set, fields, reshape(fields%temperature, &
        [1, model%mesh%n_nodes]))
    case ('COOR')
      call print_node_rows(unit, 'coordinates (x,y,z)', model%mesh, set, fields, node_positions(model%mesh, fields, is_nlgeom))
    end select
  end subroutine print_node_variable


  !> Coordinates of the nodes: reference, under NLGEOM current [length].
  pure function node_positions(mesh, fields, is_nlgeom) result(x)
    type(mesh_type), intent(in) :: mesh
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: is_nlgeom
    real(DP) :: x(3, mesh%n_nodes)
    x = mesh%coordinates
    if (is_nlgeom) x = x + fields%u
  end function node_positions


  !> Vectors at the nodes, in the directions of TRANSFORM if requested.
  pure function in_transform(model, values, is_local) result(turned)
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: values(:, :)           !< (3, n_nodes) global
    logical, intent(in) :: is_local
    real(DP) :: turned(3, size(values, 2))
    integer :: i
    turned = values
    if (.not. (is_local .and. allocated(model%frame_of))) return
    do i = 1, size(values, 2)
      if (model%frame_of(i) > 0) turned(:, i) = matmul(values(:, i), model%frames(:, :, model%frame_of(i)))
    end do
  end function in_transform


  !> RF: the reactions of supports. CalculiX prints the internal forces at all nodes with elements; at nodes without elements,
  !! reference nodes, these are supports and loads.
  pure function printed_forces(model, fields, is_field) result(force)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    logical, intent(in), optional :: is_field      !< for .frd
    real(DP) :: force(3, model%mesh%n_nodes)
    logical :: is_contact_inside                   ! contact springs count as elements; mortar forces in tables do not
    integer :: i
    force = fields%reaction_force
    if (model%dialect /= DIALECT_CALCULIX) return
    force = force + fields%applied_force
    is_contact_inside = .not. all(model%pairs%is_mortar .and. .not. model%pairs%has_point_contact)
    if (present(is_field)) is_contact_inside = is_contact_inside .or. is_field
    do i = 1, size(model%mesh%nodes)
      associate (node => model%mesh%nodes(i))
        force(:, node) = fields%internal_force(:, node)
        if (is_contact_inside) force(:, node) = force(:, node) - fields%contact_force(:, node)
      end associate
    end do
    call add_expanded_forces(model, fields, force)
    call convert_to_sector(model%mesh, absent_elements(model, fields%step), fields, model%steps(max(1, fields%step))%is_nlgeom, &
      force)
    if (present(is_field)) force = force / sector_share(model)   ! fields contain forces of the full circle
  end function printed_forces


  !> The force at a node of shells or beams is the sum of those at the nodes into which it expands.
  pure subroutine add_expanded_forces(model, fields, force)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    real(DP), intent(inout) :: force(:, :)         !< (3, n_nodes) [force]
    integer :: i
    if (.not. allocated(model%structure)) return
    associate (directors => model%structure%directors)
      do i = 1, size(directors)
        associate (node => directors(i)%node)
          if (.not. model%mesh%has_elements(node)) force(:, node) = 0
        end associate
      end do
      do i = 1, size(directors)
        associate (node => directors(i)%node, nodes => directors(i)%nodes)
          force(:, node) = force(:, node) + sum(fields%internal_force(:, nodes), dim=2)
        end associate
      end do
    end associate
  end subroutine add_expanded_forces


  !> A block of vectors at the nodes of a set.
  subroutine print_node_rows(unit, title, mesh, set, fields, values)
    integer, intent(in) :: unit
    character(*), intent(in) :: title
    type(mesh_type), intent(in) :: mesh
    type(set_type), intent(in) :: set
    type(fields_type), intent(in) :: fields
    real(DP), intent(in) :: values(:, :)           !< (at most 3, n_nodes)
    integer :: i
    call print_head(unit, title, set, fields%total_time)
    do i = 1, size(set%members)
      write (unit, NODE_FORMAT) mesh%node_label(set%members(i)), values(:, set%members(i))
    end do
  end subroutine print_node_rows


  !> S, E, ME, PEEQ, CEEQ, SDEG, DMICRT, SDV, ENER, COORD at the integration points of an element set; ELSE, EVOL, SF, SM of its
  !! elements.
  subroutine print_element_variable(unit, model, fields, request, variable, is_nlgeom)
    integer, intent(in) :: unit
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(print_request_type), intent(in) :: request
    character(*), intent(in) :: variable
    logical, intent(in) :: is_nlgeom
    type(set_type) :: set
    real(DP), allocatable :: places(:, :), damage(:, :)
    set = set_of(model%mesh, request)
    associate (time => fields%total_time, mesh => model%mesh)
      select case (variable)
      case ('S')
        call print_head(unit, 'stresses (elem, integ.pnt.,sxx,syy,szz,sxy,sxz,syz)', set, time)
        call print_tensors(rotate_truss_tensors(model, fields, is_nlgeom, fields%stress))
      case ('ME')
        call print_head(unit, 'mechanical strains (elem, integ.pnt.,exx,eyy,ezz,exy,exz,eyz)', set, time)
        call print_tensors(rotate_truss_tensors(model, fields, .false., mechanical_strain(model, fields)))
      case ('E', 'LE')
        call print_head(unit, 'strains (elem, integ.pnt.,exx,eyy,ezz,exy,exz,eyz)', set, time)
        call print_tensors(rotate_truss_tensors(model, fields, .false., fields%strain))
      case ('PEEQ')
        if (model%dialect == DIALECT_CALCULIX .and. size(fields%history, 1) == 0) return   ! no plasticity
        call print_head(unit, 'equivalent plastic strain (elem, integ.pnt.,pe)', set, time)
        call print_point_rows(unit, model, fields%step, set, reshape(equivalent_plastic_strain(model, fields), [1, mesh%n_points]))
      case ('CEEQ')
        call print_head(unit, 'equivalent creep strain (elem, integ.pnt.,ce)', set, time)
        call print_point_rows(unit, model, fields%step, set, reshape(history_variable(fields, HISTORY_CEEQ), [1, mesh%n_points]))
      case ('SDEG')
        damage = damage_variables(model, fields)
        call print_head(unit, 'damage (elem, integ.pnt.,sdeg)', set, time)
        call print_point_rows(unit, model, fields%step, set, damage(1:1, :))
      case ('DMIC')
        damage = damage_variables(model, fields)
        call print_head(unit, 'criterion of damage (elem, integ.pnt.,dmicrt)', set, time)
        call print_point_rows(unit, model, fields%step, set, damage(2:2, :))
      case ('SDV')
        if (n_state_variables(model, fields) == 0) return   ! no state variables
        call print_head(unit, 'internal state variables (elem, integ.pnt.,values)', set, time)
        call print_point_rows(unit, model, fields%step, set, state_variables(model, fields))
      case ('ENER')
        call print_head(unit, 'internal energy density (elem, integ.pnt.,energy)', set, time)
        call print_point_rows(unit, model, fields%step, set, reshape(printed_energy_density(model, fields), [1, mesh%n_points]))
      case ('COOR')
        allocate (places(3, mesh%n_points))
        call integration_point_positions(mesh, node_positions(mesh, fields, is_nlgeom), places)
        call print_head(unit, 'global coordinates (elem, integ.pnt.,x,y,z)', set, time)
        call print_point_rows(unit, model, fields%step, set, places)
      case ('ELSE')
        call print_element_rows(unit, ['internal energy (element, energy)', 'total internal energy            '], &
          model, fields%step, request, time, printed_energy_density(model, fields))
      case ('EVOL')
        call print_element_rows(unit, ['volume (element, volume)', 'total volume            '], model, fields%step, &
          request, time)
      case ('SF')
        call print_head(unit, 'section forces (elem, sf1,sf2,sf3,sf4,sf5,sf6)', set, time)
        call print_section_rows(unit, model, fields, set, 1, 6)
      case ('SM')
        call print_head(unit, 'section moments (elem, sm1,sm2,sm3)', set, time)
        call print_section_rows(unit, model, fields, set, 7, N_SECTION_FORCES)
      end select
    end associate

  contains

    !> Prints tensors in CalculiX's order: xx yy zz xy xz yz.
    subroutine print_tensors(values)
      real(DP), intent(in) :: values(:, :)         !< (6, n_points) xx yy zz xy yz xz, global
      integer, parameter :: PRINTED_ORDER(6) = [1, 2, 3, 4, 6, 5]
      real(DP), allocatable :: turned(:, :)
      turned = in_orientation(model%mesh, fields, values, request%is_local)
      call print_point_rows(unit, model, fields%step, set, turned(PRINTED_ORDER, :))
    end subroutine print_tensors

  end subroutine print_element_variable


  !> Rows of section forces of the shells and beams of a set; a composite shell has one.
  subroutine print_section_rows(unit, model, fields, set, first, last)
    integer, intent(in) :: unit
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(set_type), intent(in) :: set
    integer, intent(in) :: first, last             !< of the section forces
    real(DP), allocatable :: forces(:, :)
    integer :: i
    if (.not. allocated(model%structure)) return
    allocate (forces(N_SECTION_FORCES, model%mesh%n_elements))
    call find_section_forces(model, fields, forces)
    do i = 1, size(set%members)
      associate (e => set%members(i))
        if (model%structure%section(e) == 0 .or. model%mesh%layer(e) > 1 .or. is_out(model, fields%step, e)) cycle
        write (unit, ELEMENT_FORMAT) model%mesh%element_label(e), forces(first:last, e)
      end associate
    end do
  end subroutine print_section_rows


  !> Tensors at the points, in the axes of their orientation if requested.
  pure function in_orientation(mesh, fields, values, is_local) result(turned)
    type(mesh_type), intent(in) :: mesh
    type(fields_type), intent(in) :: fields
    real(DP), intent(in) :: values(:, :)           !< (6, n_points) xx yy zz xy yz xz, global
    logical, intent(in) :: is_local
    real(DP) :: turned(6, size(values, 2))
    integer :: e, p
    turned = values
    if (.not. (is_local .and. allocated(fields%frame))) return
    do e = 1, mesh%n_elements
      if (is_cohesive(mesh%kind(e))) cycle         ! in the axes of their faces already
      do p = mesh%point_first(e), mesh%point_first(e + 1) - 1
        associate (R => fields%frame(:, :, p))
          turned(:, p) = pack_voigt(matmul(transpose(R), matmul(unpack_voigt(values(:, p)), R)))
        end associate
      end do
    end do
  end function in_orientation


  !> Rows of the integration points of the elements of a set.
  subroutine print_point_rows(unit, model, step, set, values)
    integer, intent(in) :: unit
    type(model_type), intent(in) :: model
    integer, intent(in) :: step                    !< index into model%steps
    type(set_type), intent(in) :: set
    real(DP), intent(in) :: values(:, :)           !< (n_components, n_points)
    real(DP) :: matrix(MAX_PRINTED_POINTS, MAX_ELEMENT_POINTS), row(size(values, 1))
    integer :: i, p, k, first, n, n_rows, below
    do i = 1, size(set%members)
      associate (e => set%members(i), mesh => model%mesh)
        if (is_out(model, step, e)) cycle
        first = mesh%point_first(e)
        n = mesh%point_first(e + 1) - first
        call find_printed_points(model, e, n_rows, matrix)
        do p = 1, n_rows
          row = 0
          do k = 1, n
            row = row + matrix(p, k) * values(:, first + k - 1)
          end do
          write (unit, POINT_FORMAT) mesh%element_label(e), p, row
        end do
        if (n_rows > 0) cycle
        below = layers_below(model, e)
        do p = 1, n
          write (unit, POINT_FORMAT) mesh%element_label(e - below), n * below + p, values(:, first + p - 1)
        end do
      end associate
    end do
  end subroutine print_point_rows


  !> The layers below an element that are printed as one element with it: those of a composite shell of the calculix dialect. They
  !! stand before it, in the mesh as in sets.
  pure integer function layers_below(model, e) result(n)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e                       !< element
    n = 0
    if (model%dialect == DIALECT_CALCULIX .and. allocated(model%mesh%layer)) n = model%mesh%layer(e) - 1
  end function layers_below


  !> A block with the integral over each element of a set of a density, or of 1, per reference volume, and their sum.
  subroutine print_element_rows(unit, titles, model, step, request, time, density)
    integer, intent(in) :: unit
    character(*), intent(in) :: titles(2)          !< of the rows, of the sum
    type(model_type), intent(in) :: model
    integer, intent(in) :: step                    !< index into model%steps
    type(print_request_type), intent(in) :: request
    real(DP), intent(in) :: time                   !< total time [time]
    real(DP), intent(in), optional :: density(:)   !< (n_points); default 1
    type(set_type) :: set
    real(DP) :: volumes(MAX_ELEMENT_POINTS), integral, total, share, of_layers
    integer :: i, n, first, below
    set = set_of(model%mesh, request)
    if (.not. request%is_only_totals) call print_head(unit, trim(titles(1)), set, time)
    total = 0
    of_layers = 0
    share = sector_share(model)
    associate (mesh => model%mesh)
      do i = 1, size(set%members)
        if (is_out(model, step, set%members(i))) cycle
        call integration_point_volumes(mesh, set%members(i), n, volumes)
        integral = sum(volumes(:n))
        first = mesh%point_first(set%members(i))
        if (present(density)) integral = dot_product(volumes(:n), density(first:first + n - 1))
        integral = share * integral
        total = total + integral
        below = layers_below(model, set%members(i))
        of_layers = integral + merge(of_layers, 0.0_DP, below > 0)
        if (request%is_only_totals) cycle
        if (i < size(set%members)) then
          if (layers_below(model, set%members(i + 1)) > below) cycle
        end if
        write (unit, NODE_FORMAT) mesh%element_label(set%members(i) - below), of_layers
      end do
    end associate
    if (.not. (request%is_totals .or. request%is_only_totals)) return
    call print_head(unit, trim(titles(2)), set, time)
    write (unit, TOTAL_FORMAT) total
  end subroutine print_element_rows


  !> The head line of a block, with blank lines around it.
  subroutine print_head(unit, title, set, time)
    integer, intent(in) :: unit
    character(*), intent(in) :: title
    type(set_type), intent(in) :: set
    real(DP), intent(in) :: time                   !< total time [time]
    write (unit, '(/5a,e14.7/)') ' ', title, ' for set ', upper_case(set%name), ' and time ', time
  end subroutine print_head

end module amontons_dat_output
