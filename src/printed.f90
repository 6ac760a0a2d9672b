!> Printed: job.sta and job.cvg, a line per attempt and per iteration, and job.dat for the PRINT cards.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The columns are those of CalculiX, so that programs which read its files read ours; what we add stands to the right.
!! Lines of .sta and .cvg are brought to disk one by one, since such programs watch them while the job runs.
!!
!! Where the two parents of the deck language mean different things by RF, the dialect decides: under calculix the block
!! `forces` shows all forces from outside on a node (supports, loads), under abaqus the reactions of supports alone.
module amontons_printed
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type, set_error, EXIT_IO
  use amontons_posix, only: cut_file, sync_file
  use amontons_text, only: upper_case
  use amontons_tensor, only: cross_product, pack_voigt, unpack_voigt
  use amontons_topology, only: MAX_POINTS, N_SOLID_KINDS
  use amontons_derived, only: bar_points, measure_section, mechanical_strain, pair_sums_type, point_places, point_volumes, &
    section_type, sector_share, shown_density, shown_energy, shown_slip, sum_pair, take_sector, turn_trusses
  use amontons_mesh, only: mesh_type, set_type, is_out
  use amontons_steps, only: is_output_due, print_request_type, PRINT_CONTACT, PRINT_ELEMENT, PRINT_NODE, &
    PRINT_SECTION
  use amontons_materials, only: HISTORY_CEEQ
  use amontons_model, only: job_options_type, job_path, model_type, DIALECT_CALCULIX
  use amontons_history, only: increment_record_type, iteration_record_type
  use amontons_state, only: history_row, inelastic_strain, inner_variables, n_inner_variables, fields_type, slave_type, STATUS_OPEN
  implicit none
  private
  public :: printed_type, open_printed, resume_printed, sync_printed, measure_printed, check_printed, print_iteration, &
    print_increment, print_fields, close_printed, contact_axes, printed_forces, in_directions, in_axes

  !> The text files of a job that are being written. Units are 0 if not open.
  type :: printed_type
    private
    integer :: sta = 0
    integer :: cvg = 0
    integer :: dat = 0
    character(:), allocatable :: sta_path, cvg_path, dat_path
    integer :: status = 0                    !< of the first line that could not be written
  end type printed_type

  character(*), parameter :: NODE_FORM = '(i10,1p,3(1x,e13.6))'
  character(*), parameter :: SIDE_FORM = '(i10,1x,i10,1p,8(1x,e13.6))'     !< a row of a point of an element's face
  character(*), parameter :: POINT_FORM = '(i10,1x,i3,1p,*(1x,e13.6))'
  character(*), parameter :: TOTAL_FORM = '(6x,1p,3(1x,e13.6))'
  character(*), parameter :: STATISTICS_FORM = '(2x,1p,6(1x,e13.6))'

contains

  !> Opens job.sta and job.cvg with their head lines, and job.dat if a step has PRINT cards.
  subroutine open_printed(printed, model, options, error)
    type(printed_type), intent(out) :: printed
    type(model_type), intent(in) :: model
    type(job_options_type), intent(in) :: options
    type(error_type), allocatable, intent(out) :: error
    integer :: status
    printed%sta_path = job_path(options, '.sta')
    call open_text(printed%sta_path, printed%sta, error)
    if (allocated(error)) return
    write (printed%sta, '(a)', iostat=status) 'SUMMARY OF JOB INFORMATION', &
      '  STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME' // &
      '    OPEN  STICK   SLIP      S-I     S-II    S-III     S-IV  CUT  FACT  KRYLOV   RESIDUAL  CORRECTION'
    if (printed%status == 0) printed%status = status
    call bring_out(printed, printed%sta)
    printed%cvg_path = job_path(options, '.cvg')
    call open_text(printed%cvg_path, printed%cvg, error)
    if (allocated(error)) return
    write (printed%cvg, '(a)', iostat=status) 'SUMMARY OF C0NVERGENCE INFORMATION', &
      '  STEP   INC  ATT   ITER     CONT.   RESID.        CORR.      RESID.      CORR.' // &
      '    OPEN  STICK   SLIP    S-I   S-II  S-III   S-IV OPENED CLOSED KRYLOV       STEP        WORST BALANC ROUNDS', &
      '                              EL.    FORCE         DISP       FLUX        TEMP.' // &
      '                                                                      LENGTH          GAP', &
      '                              (#)     (%)           (%)        (%)         (%)' // &
      '     (#)    (#)    (#)    (#)    (#)    (#)    (#)    (#)    (#)    (#)         (-)     (LENGTH)'
    if (printed%status == 0) printed%status = status
    call bring_out(printed, printed%cvg)
    if (.not. has_prints(model)) return
    printed%dat_path = job_path(options, '.dat')
    call open_text(printed%dat_path, printed%dat, error)
  end subroutine open_printed


  !> Opens the files of a job that goes on after a checkpoint: each is cut off where it was then.
  subroutine resume_printed(printed, model, options, lengths, error)
    type(printed_type), intent(out) :: printed
    type(model_type), intent(in) :: model
    type(job_options_type), intent(in) :: options
    integer(I64), intent(in) :: lengths(3)         !< of .sta, .cvg, .dat [bytes]
    type(error_type), allocatable, intent(out) :: error
    printed%sta_path = job_path(options, '.sta')
    call reopen_text(printed%sta_path, lengths(1), printed%sta, error)
    if (allocated(error)) return
    printed%cvg_path = job_path(options, '.cvg')
    call reopen_text(printed%cvg_path, lengths(2), printed%cvg, error)
    if (allocated(error) .or. .not. has_prints(model)) return
    printed%dat_path = job_path(options, '.dat')
    call reopen_text(printed%dat_path, lengths(3), printed%dat, error)
  end subroutine resume_printed


  !> Brings the files to the medium.
  subroutine sync_printed(printed, error)
    type(printed_type), intent(in) :: printed
    type(error_type), allocatable, intent(out) :: error
    call check_printed(printed, error)
    if (.not. allocated(error) .and. printed%sta /= 0) call sync_file(printed%sta_path, error)
    if (.not. allocated(error) .and. printed%cvg /= 0) call sync_file(printed%cvg_path, error)
    if (.not. allocated(error) .and. printed%dat /= 0) call sync_file(printed%dat_path, error)
  end subroutine sync_printed


  !> How long the files are now.
  subroutine measure_printed(printed, lengths)
    type(printed_type), intent(inout) :: printed
    integer(I64), intent(out) :: lengths(3)        !< of .sta, .cvg, .dat; 0 if not open [bytes]
    lengths = 0
    call measure(printed%sta, lengths(1))
    call measure(printed%cvg, lengths(2))
    call measure(printed%dat, lengths(3))

  contains

    !> One of them.
    subroutine measure(unit, length)
      integer, intent(in) :: unit
      integer(I64), intent(inout) :: length
      if (unit == 0) return
      call bring_out(printed, unit)
      inquire (unit=unit, size=length)
    end subroutine measure

  end subroutine measure_printed


  !> An error if a line could not be written since the files were opened: a full disk.
  subroutine check_printed(printed, error)
    type(printed_type), intent(in) :: printed
    type(error_type), allocatable, intent(out) :: error
    if (printed%status /= 0) call set_error(error, EXIT_IO, 'Cannot write the file ' // printed%sta_path // ' or ' // &
      'the .cvg or .dat beside it (is the disk full?).')
  end subroutine check_printed


  !> Closes a file; the first trouble is kept.
  subroutine close_text(printed, unit)
    type(printed_type), intent(inout) :: printed
    integer, intent(in) :: unit
    integer :: status
    if (unit == 0) return
    close (unit, iostat=status)
    if (printed%status == 0) printed%status = status
  end subroutine close_text


  !> Whether a step has PRINT cards.
  pure logical function has_prints(model)
    type(model_type), intent(in) :: model
    integer :: i
    has_prints = .false.
    do i = 1, size(model%steps)
      if (allocated(model%steps(i)%prints)) has_prints = has_prints .or. size(model%steps(i)%prints) > 0
    end do
  end function has_prints


  !> Flushes a file; the first trouble is kept.
  subroutine bring_out(printed, unit)
    type(printed_type), intent(inout) :: printed
    integer, intent(in) :: unit
    integer :: status
    flush (unit, iostat=status)
    if (printed%status == 0) printed%status = status
  end subroutine bring_out


  !> Opens a text file to go on behind a length that it has.
  subroutine reopen_text(path, length, unit, error)
    character(*), intent(in) :: path
    integer(I64), intent(in) :: length             !< [bytes]
    integer, intent(out) :: unit
    type(error_type), allocatable, intent(out) :: error
    character(200) :: reason
    integer :: status
    unit = 0
    call cut_file(path, length, error)
    if (allocated(error)) return
    open (newunit=unit, file=path, status='old', action='write', form='formatted', position='append', iostat=status, &
      iomsg=reason)
    if (status == 0) return
    unit = 0
    call set_error(error, EXIT_IO, 'Cannot open the file ' // path // ': ' // trim(reason) // '.')
  end subroutine reopen_text


  !> Creates a text file, or empties it if it exists.
  subroutine open_text(path, unit, error)
    character(*), intent(in) :: path
    integer, intent(out) :: unit
    type(error_type), allocatable, intent(out) :: error
    character(200) :: reason
    integer :: status
    open (newunit=unit, file=path, status='replace', action='write', form='formatted', iostat=status, iomsg=reason)
    if (status == 0) return
    unit = 0
    call set_error(error, EXIT_IO, 'Cannot create the file ' // path // ': ' // trim(reason) // '.')
  end subroutine open_text


  !> Writes a line of .cvg. Residual and correction are in per cent, as in CalculiX.
  subroutine print_iteration(printed, record)
    type(printed_type), intent(inout) :: printed
    type(iteration_record_type), intent(in) :: record
    integer :: status
    if (printed%cvg == 0) return
    write (printed%cvg, '(2x,i4,2x,i4,2x,i4,2x,i4,2x,i7,4(1x,e11.4),3(1x,i6),4(1x,i6),3(1x,i6),2(1x,e12.5),2(1x,i6))', &
      iostat=status) &
      record%step, record%increment, record%attempt, record%iteration, record%n_closed, 100 * record%residual, &
      100 * record%correction, 0.0_DP, 0.0_DP, record%n_status, record%n_scenario, record%n_opened, &
      record%n_closed_now, record%n_krylov, record%step_length, record%worst_gap, record%n_balanced, record%n_rounds
    if (printed%status == 0) printed%status = status
    call bring_out(printed, printed%cvg)
  end subroutine print_iteration


  !> Writes a line of .sta; an attempt that failed has a U behind its number and the times at which it began.
  subroutine print_increment(printed, record)
    type(printed_type), intent(inout) :: printed
    type(increment_record_type), intent(in) :: record
    character(*), parameter :: OURS = '3(1x,i6),4(1x,i8),1x,i4,1x,i5,1x,i7,2(1x,e11.4))'
    real(DP) :: back
    integer :: status
    character(:), allocatable :: form
    if (printed%sta == 0) return
    if (record%is_converged) then
      form = '(1x,i5,1x,i10,2(1x,i5),3(1x,e13.6),' // OURS
      back = 0
    else
      form = '(1x,i5,1x,i10,1x,i5,''U'',1x,i4,3(1x,e13.6),' // OURS
      back = record%dt
    end if
    write (printed%sta, form, iostat=status) record%step, record%increment, record%attempt, record%n_iterations, &
      record%total_time - back, record%step_time - back, record%dt, record%n_status, record%n_scenario, &
      record%n_cutbacks, record%n_factorisations, record%n_krylov, record%residual, record%correction
    if (printed%status == 0) printed%status = status
    call bring_out(printed, printed%sta)
    if (printed%cvg /= 0) call print_course(printed, record)
    call bring_out(printed, printed%cvg)
  end subroutine print_increment


  !> Writes below the iterations of an attempt what they do not tell: cycles, bodies that were carried, why it failed.
  subroutine print_course(printed, record)
    type(printed_type), intent(inout) :: printed
    type(increment_record_type), intent(in) :: record
    character(:), allocatable :: words
    integer :: status, i
    status = 0
    if (record%n_cycles > 0) &
      write (printed%cvg, '(a,i0)', iostat=status) '  ** cycles of slave nodes that were acted on: ', record%n_cycles
    if (printed%status == 0) printed%status = status
    if (.not. record%is_converged .and. allocated(record%reason)) &
      write (printed%cvg, '(2a)', iostat=status) '  ** ', record%reason
    if (printed%status == 0) printed%status = status
    if (allocated(record%story)) then
      do i = 1, size(record%story)
        if (record%story(i) /= '') write (printed%cvg, '(2a)', iostat=status) '  ** ', trim(record%story(i))
        if (printed%status == 0) printed%status = status
      end do
    end if
    if (.not. record%is_converged .or. record%n_carried == 0) return
    words = '  ** carried in '
    if (record%n_snapped > 0) words = '  ** carried to another balance in '
    write (printed%cvg, '(a,i0,a,es11.4,a)', iostat=status) words, record%n_carried, ' iterations, work ', &
      record%carried_now, ', nothing of it left at the end'
    if (printed%status == 0) printed%status = status
  end subroutine print_course


  !> Writes what the PRINT cards of the step ask of a converged increment; nothing if its turn has not come
  !! (print_frequency), and nothing for increment 0.
  subroutine print_fields(printed, model, fields, record, error)
    type(printed_type), intent(in) :: printed
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields                  !< committed
    type(increment_record_type), intent(in) :: record
    type(error_type), allocatable, intent(out) :: error
    integer :: i, status
    character(200) :: reason
    if (printed%dat == 0 .or. record%increment == 0) return
    associate (step => model%steps(record%step))
      if (.not. allocated(step%prints)) return
      if (size(step%prints) == 0) return
      if (.not. is_output_due(step, step%print_frequency, record%increment, record%step_time, &
        step%print_times)) return
      write (printed%dat, '(/24x,a,i5,///,32x,a,i5,/)') 'S T E P   ', record%step, 'INCREMENT ', record%increment
      do i = 1, size(step%prints)
        call print_request(printed%dat, model, fields, step%prints(i), step%is_nlgeom)
      end do
    end associate
    flush (printed%dat, iostat=status, iomsg=reason)
    if (status /= 0) call set_error(error, EXIT_IO, 'Cannot write the file ' // printed%dat_path // ': ' // &
      trim(reason) // '.')
  end subroutine print_fields


  !> Closes the files that are open.
  subroutine close_printed(printed)
    type(printed_type), intent(inout) :: printed
    call close_text(printed, printed%sta)
    call close_text(printed, printed%cvg)
    call close_text(printed, printed%dat)
    printed = printed_type()
  end subroutine close_printed


  !> One PRINT card: a block per variable. The reader has refused variables that are not known here.
  subroutine print_request(unit, model, fields, request, is_nlgeom)
    integer, intent(in) :: unit
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(print_request_type), intent(in) :: request
    logical, intent(in) :: is_nlgeom               !< of the step
    integer :: i
    if (request%kind == PRINT_SECTION) then
      call print_surface(unit, model, fields, request%set, is_nlgeom)
      return
    end if
    do i = 1, size(request%variables)
      select case (request%kind)
      case (PRINT_NODE)
        call print_node_variable(unit, model, fields, request, request%variables(i), is_nlgeom)
      case (PRINT_ELEMENT)
        call print_element_variable(unit, model, fields, request, request%variables(i), is_nlgeom)
      case (PRINT_CONTACT)
        if (any(block_of(request%variables(:i - 1)) == block_of(request%variables(i)))) cycle
        call print_contact_variable(unit, model, fields, request, block_of(request%variables(i)))
      end select
    end do
  end subroutine print_request


  !> The set of a request; without one all nodes or elements that there are.
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


  !> U, RF, NT, COORD of a node set.
  subroutine print_node_variable(unit, model, fields, request, variable, is_nlgeom)
    integer, intent(in) :: unit
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(print_request_type), intent(in) :: request
    character(*), intent(in) :: variable
    logical, intent(in) :: is_nlgeom
    type(set_type) :: set
    real(DP), allocatable :: force(:, :)
    set = set_of(model%mesh, request)
    select case (variable)
    case ('U')
      call print_node_rows(unit, 'displacements (vx,vy,vz)', model%mesh, set, fields, &
        in_directions(model, fields%u, request%is_local))
    case ('RF')
      force = in_directions(model, printed_forces(model, fields), request%is_local)
      if (.not. request%is_only_totals) &
        call print_node_rows(unit, 'forces (fx,fy,fz)', model%mesh, set, fields, force)
      if (.not. (request%is_totals .or. request%is_only_totals)) return
      call print_head(unit, 'total force (fx,fy,fz)', set, fields%total_time)
      force = printed_forces(model, fields)        ! a sum has no local directions
      write (unit, TOTAL_FORM) sum(force(:, set%members), 2)
    case ('NT')
      call print_node_rows(unit, 'temperatures', model%mesh, set, fields, reshape(fields%temperature, &
        [1, model%mesh%n_nodes]))
    case ('COOR')
      call print_node_rows(unit, 'coordinates (x,y,z)', model%mesh, set, fields, places_of(model%mesh, fields, is_nlgeom))
    end select
  end subroutine print_node_variable


  !> The places of the nodes: in the deck, under NLGEOM now.
  pure function places_of(mesh, fields, is_nlgeom) result(x)
    type(mesh_type), intent(in) :: mesh
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: is_nlgeom
    real(DP) :: x(3, mesh%n_nodes)
    x = mesh%coordinates
    if (is_nlgeom) x = x + fields%u
  end function places_of


  !> Vectors at the nodes, in the directions of TRANSFORM if a card asks for these.
  pure function in_directions(model, values, is_local) result(turned)
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
  end function in_directions


  !> RF: the reactions of supports. CalculiX prints the internal forces at all nodes that have elements; where there are none, at
  !! reference nodes, these are supports and loads.
  pure function printed_forces(model, fields, is_field) result(force)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    logical, intent(in), optional :: is_field      !< for .frd
    real(DP) :: force(3, model%mesh%n_nodes)
    logical :: is_contact_inside                   ! springs of contact count as elements; in tables mortar's forces do not
    integer :: i
    force = fields%reaction_force
    if (model%dialect /= DIALECT_CALCULIX) return
    force = force + fields%applied_force
    is_contact_inside = .not. all(model%pairs%is_mortar .and. .not. model%pairs%is_pointwise)
    if (present(is_field)) is_contact_inside = is_contact_inside .or. is_field
    do i = 1, size(model%mesh%nodes)
      associate (node => model%mesh%nodes(i))
        force(:, node) = fields%internal_force(:, node)
        if (is_contact_inside) force(:, node) = force(:, node) - fields%contact_force(:, node)
      end associate
    end do
    call take_sector(model%mesh, fields, model%steps(max(1, fields%step))%is_nlgeom, force)
    if (present(is_field)) force = force / sector_share(model)   ! a field has those of the whole circle
  end function printed_forces


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
      write (unit, NODE_FORM) mesh%node_label(set%members(i)), values(:, set%members(i))
    end do
  end subroutine print_node_rows


  !> S, E, ME, PEEQ, CEEQ, ENER, COORD at the integration points of an element set; ELSE, EVOL of its elements.
  subroutine print_element_variable(unit, model, fields, request, variable, is_nlgeom)
    integer, intent(in) :: unit
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(print_request_type), intent(in) :: request
    character(*), intent(in) :: variable
    logical, intent(in) :: is_nlgeom
    type(set_type) :: set
    real(DP), allocatable :: places(:, :)
    set = set_of(model%mesh, request)
    associate (time => fields%total_time, mesh => model%mesh)
      select case (variable)
      case ('S')
        call print_head(unit, 'stresses (elem, integ.pnt.,sxx,syy,szz,sxy,sxz,syz)', set, time)
        call print_tensors(turn_trusses(model, fields, is_nlgeom, fields%stress))
      case ('ME')
        call print_head(unit, 'mechanical strains (elem, integ.pnt.,exx,eyy,ezz,exy,exz,eyz)', set, time)
        call print_tensors(turn_trusses(model, fields, .false., mechanical_strain(model, fields)))
      case ('E', 'LE')
        call print_head(unit, 'strains (elem, integ.pnt.,exx,eyy,ezz,exy,exz,eyz)', set, time)
        call print_tensors(turn_trusses(model, fields, .false., fields%strain))
      case ('PEEQ')
        if (model%dialect == DIALECT_CALCULIX .and. size(fields%history, 1) == 0) return   ! nothing flows
        call print_head(unit, 'equivalent plastic strain (elem, integ.pnt.,pe)', set, time)
        call print_point_rows(unit, model, set, reshape(inelastic_strain(model, fields), [1, mesh%n_points]))
      case ('CEEQ')
        call print_head(unit, 'equivalent creep strain (elem, integ.pnt.,ce)', set, time)
        call print_point_rows(unit, model, set, reshape(history_row(fields, HISTORY_CEEQ), [1, mesh%n_points]))
      case ('SDV')
        if (n_inner_variables(model, fields) == 0) return   ! no material has any
        call print_head(unit, 'internal state variables (elem, integ.pnt.,values)', set, time)
        call print_point_rows(unit, model, set, inner_variables(model, fields))
      case ('ENER')
        call print_head(unit, 'internal energy density (elem, integ.pnt.,energy)', set, time)
        call print_point_rows(unit, model, set, reshape(shown_density(model, fields), [1, mesh%n_points]))
      case ('COOR')
        allocate (places(3, mesh%n_points))
        call point_places(mesh, places_of(mesh, fields, is_nlgeom), places)
        call print_head(unit, 'global coordinates (elem, integ.pnt.,x,y,z)', set, time)
        call print_point_rows(unit, model, set, places)
      case ('ELSE')
        call print_element_rows(unit, ['internal energy (element, energy)', 'total internal energy            '], &
          model, request, time, shown_density(model, fields))
      case ('EVOL')
        call print_element_rows(unit, ['volume (element, volume)', 'total volume            '], model, request, time)
      end select
    end associate

  contains

    !> A tensor as CalculiX prints it: xx yy zz xy xz yz.
    subroutine print_tensors(values)
      real(DP), intent(in) :: values(:, :)         !< (6, n_points) xx yy zz xy yz xz, global
      integer, parameter :: ORDER(6) = [1, 2, 3, 4, 6, 5]
      real(DP), allocatable :: turned(:, :)
      turned = in_axes(fields, values, request%is_local)
      call print_point_rows(unit, model, set, turned(ORDER, :))
    end subroutine print_tensors

  end subroutine print_element_variable


  !> Tensors at the points, in the axes of their orientation if a card asks for these.
  pure function in_axes(fields, values, is_local) result(turned)
    type(fields_type), intent(in) :: fields
    real(DP), intent(in) :: values(:, :)           !< (6, n_points) xx yy zz xy yz xz, global
    logical, intent(in) :: is_local
    real(DP) :: turned(6, size(values, 2))
    integer :: p
    turned = values
    if (.not. (is_local .and. allocated(fields%frame))) return
    do p = 1, size(values, 2)
      associate (R => fields%frame(:, :, p))
        turned(:, p) = pack_voigt(matmul(transpose(R), matmul(unpack_voigt(values(:, p)), R)))
      end associate
    end do
  end function in_axes


  !> Rows of the integration points of the elements of a set.
  subroutine print_point_rows(unit, model, set, values)
    integer, intent(in) :: unit
    type(model_type), intent(in) :: model
    type(set_type), intent(in) :: set
    real(DP), intent(in) :: values(:, :)           !< (n_components, n_points)
    integer :: i, p, first, n
    do i = 1, size(set%members)
      associate (e => set%members(i), mesh => model%mesh)
        if (is_out(mesh, e)) cycle
        first = mesh%point_first(e)
        n = mesh%point_first(e + 1) - first
        do p = 1, bar_points(model, e)
          write (unit, POINT_FORM) mesh%element_label(e), p, sum(values(:, first:first + n - 1), dim=2) / real(n, DP)
        end do
        if (bar_points(model, e) > 0) cycle
        do p = 1, n
          write (unit, POINT_FORM) mesh%element_label(e), p, values(:, first + p - 1)
        end do
      end associate
    end do
  end subroutine print_point_rows


  !> A block with the integral over each element of a set of a density, or of 1, per reference volume, and their sum.
  subroutine print_element_rows(unit, titles, model, request, time, density)
    integer, intent(in) :: unit
    character(*), intent(in) :: titles(2)          !< of the rows, of the sum
    type(model_type), intent(in) :: model
    type(print_request_type), intent(in) :: request
    real(DP), intent(in) :: time                   !< total time [time]
    real(DP), intent(in), optional :: density(:)   !< (n_points); default 1
    type(set_type) :: set
    real(DP) :: volumes(MAX_POINTS), integral, total, share
    integer :: i, n, first
    set = set_of(model%mesh, request)
    if (.not. request%is_only_totals) call print_head(unit, trim(titles(1)), set, time)
    total = 0
    share = sector_share(model)
    associate (mesh => model%mesh)
      do i = 1, size(set%members)
        if (is_out(mesh, set%members(i))) cycle
        call point_volumes(mesh, set%members(i), n, volumes)
        integral = sum(volumes(:n))
        first = mesh%point_first(set%members(i))
        if (present(density)) integral = dot_product(volumes(:n), density(first:first + n - 1))
        integral = share * integral
        total = total + integral
        if (.not. request%is_only_totals) write (unit, NODE_FORM) mesh%element_label(set%members(i)), integral
      end do
    end associate
    if (.not. (request%is_totals .or. request%is_only_totals)) return
    call print_head(unit, trim(titles(2)), set, time)
    write (unit, TOTAL_FORM) total
  end subroutine print_element_rows


  !> CDIS, CSTR, CELS of the closed slave nodes or points of slave faces, their number CNUM, our SCEN, and the statistics CF, CFN,
  !! CFS of each pair.
  !!
  !! As in CalculiX pressure is positive, a gap negative is penetration, and the tangential components are slip and the
  !! shear stress that goes with it (that on the master, in the direction of slip of the slave).
  subroutine print_contact_variable(unit, model, fields, request, variable)
    integer, intent(in) :: unit
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(print_request_type), intent(in) :: request
    character(*), intent(in) :: variable
    type(slave_type), allocatable :: slaves(:)
    character(:), allocatable :: label
    real(DP) :: share                              ! of the circle
    integer :: i
    slaves = chosen_slaves(model, fields%slaves, request)
    share = sector_share(model)
    label = 'slave node'
    if (any(slaves%side > 0)) label = 'slave element+face'
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
        if (slaves(i)%status /= STATUS_OPEN) call print_slave(unit, model, slaves(i), [share * shown_energy(model, slaves(i))])
      end do
      if (.not. (request%is_totals .or. request%is_only_totals)) return
      write (unit, '(/a,e14.7/)') ' total contact spring energy for time ', fields%total_time
      write (unit, TOTAL_FORM) share * sum([(shown_energy(model, slaves(i)), i=1, size(slaves))])
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


  !> The block that holds a sum over a pair: Abaqus has a name for each part of it.
  elemental function block_of(variable) result(name)
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
  end function block_of


  !> Whether a CONTACT PRINT is of a pair.
  pure logical function is_chosen_pair(model, request, pair) result(is_chosen)
    type(model_type), intent(in) :: model
    type(print_request_type), intent(in) :: request
    integer, intent(in) :: pair
    is_chosen = (request%slave == 0 .or. request%slave == model%pairs(pair)%slave) .and. &
      (request%master == 0 .or. request%master == model%pairs(pair)%master)
  end function is_chosen_pair


  !> The slave nodes that a CONTACT PRINT is of.
  pure function chosen_slaves(model, slaves, request) result(chosen)
    type(model_type), intent(in) :: model
    type(slave_type), intent(in) :: slaves(:)
    type(print_request_type), intent(in) :: request
    type(slave_type), allocatable :: chosen(:)
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
    type(slave_type), intent(in) :: slaves(:)
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
          row = matmul(shown_slip(model, slave), axes)
          row(1) = slave%gap
        end if
        call print_slave(unit, model, slave, row)
      end associate
    end do
  end subroutine print_slave_rows


  !> The row of a slave node by its label, that of a point by those of its element and face. CalculiX draws plane elements out into
  !! solids, whose faces 3 to 6 are their edges.
  subroutine print_slave(unit, model, slave, values)
    integer, intent(in) :: unit
    type(model_type), intent(in) :: model
    type(slave_type), intent(in) :: slave
    real(DP), intent(in) :: values(:)
    integer :: face
    if (slave%side == 0) then
      write (unit, NODE_FORM) model%mesh%node_label(slave%node), values
      return
    end if
    associate (surface => model%surfaces(model%pairs(slave%pair)%slave))
      face = surface%face(slave%side)
      if (model%mesh%kind(surface%element(slave%side)) > N_SOLID_KINDS) face = face + 2
      write (unit, SIDE_FORM) model%mesh%element_label(surface%element(slave%side)), face, values
    end associate
  end subroutine print_slave


  !> The normal and two tangents as CalculiX takes them: the x axis laid into the tangent plane (the z axis if the
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


  !> Force, moment, area and mean normal of the slave side of one pair; under the abaqus dialect also where the force acts.
  subroutine print_statistics(unit, model, fields, slaves, i_pair, variable)
    integer, intent(in) :: unit
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(slave_type), intent(in) :: slaves(:)      !< of the pair
    integer, intent(in) :: i_pair
    character(*), intent(in) :: variable           !< CF all forces, CFN the normal ones, CFS the tangential ones
    character(:), allocatable :: part
    type(pair_sums_type) :: sums
    real(DP) :: normal_force, force(3), counts(2)
    integer :: k                                   ! column of the place
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
    call sum_pair(model, fields%u, slaves, sums)
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
    write (unit, STATISTICS_FORM) sums%area, normal_force, norm2(force - normal_force * sums%normal)
    if (model%dialect == DIALECT_CALCULIX) return
    write (unit, '(/a/)') '   center of the ' // part // 'force'
    write (unit, STATISTICS_FORM) sums%place(:, k)
  end subroutine print_statistics


  !> Force, moment, centre and normal of a surface: what contact pairs and sections share.
  subroutine print_sums(unit, title, s)
    integer, intent(in) :: unit
    character(*), intent(in) :: title
    type(section_type), intent(in) :: s
    write (unit, '(/3a/)') '   ', title, ' (fx,fy,fz) and moment about the origin (mx,my,mz)'
    write (unit, STATISTICS_FORM) s%force, s%moment
    write (unit, '(/a/)') '   center of gravity and mean normal'
    write (unit, STATISTICS_FORM) s%center, s%normal
    write (unit, '(/a/)') '   moment about the center of gravity(mx,my,mz)'
    write (unit, STATISTICS_FORM) s%moment - cross_product(s%center, s%force)
  end subroutine print_sums


  !> SECTION PRINT: the sums over a surface.
  subroutine print_surface(unit, model, fields, surface, is_nlgeom)
    integer, intent(in) :: unit
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    integer, intent(in) :: surface                 !< index
    logical, intent(in) :: is_nlgeom
    type(section_type) :: s
    real(DP) :: tension, torque, moment(3)
    call measure_section(model%mesh, model%surfaces(surface), fields, is_nlgeom, model%dialect == DIALECT_CALCULIX, s)
    write (unit, '(//3a,e14.7)') ' statistics for surface set ', upper_case(model%surfaces(surface)%name), ' and time ', &
      fields%total_time
    call print_sums(unit, 'total surface force', s)
    moment = s%moment - cross_product(s%center, s%force)
    tension = dot_product(s%force, s%normal)
    torque = dot_product(moment, s%normal)
    write (unit, '(/a/)') '   area, normal force (+ = tension), shear force (size), torque and bending moment (size)'
    write (unit, STATISTICS_FORM) s%area, tension, norm2(s%force - tension * s%normal), torque, norm2(moment - torque &
      * s%normal)
  end subroutine print_surface


  !> The head line of a block, with blank lines around it.
  subroutine print_head(unit, title, set, time)
    integer, intent(in) :: unit
    character(*), intent(in) :: title
    type(set_type), intent(in) :: set
    real(DP), intent(in) :: time                   !< total time [time]
    write (unit, '(/5a,e14.7/)') ' ', title, ' for set ', upper_case(set%name), ' and time ', time
  end subroutine print_head


  !> The head line of a block of slave nodes, with blank lines around it.
  subroutine print_contact_head(unit, title, time)
    integer, intent(in) :: unit
    character(*), intent(in) :: title
    real(DP), intent(in) :: time                   !< total time [time]
    write (unit, '(/3a,e14.7/)') ' ', title, ' for all contact elements and time', time
  end subroutine print_contact_head

end module amontons_printed
