!> Queries and settings by name for a calling program. Manual: doc/manual/library.md.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Names are those of the result file; case and blanks are ignored. A node set, a surface or a label selects nodes, an element
!! set or a label selects elements, 'slave / master' or the slave surface a contact pair, '' all of them.
!! `amontons_driven_loads` applies what is set.
module amontons_job_query
  use amontons_kinds, only: DP, NAME_LENGTH
  use amontons_errors, only: error_type, set_error, EXIT_USAGE
  use amontons_containers, only: name_table_type
  use amontons_text, only: plural, verb, name_key, to_text, parse_integer, NUMBER_OK
  use amontons_element_kinds, only: element_kind_type, facet_kind_type, element_kind, facet_kind
  use amontons_mesh, only: mesh_extent
  use amontons_materials, only: HISTORY_PEEQ, USER_STATE
  use amontons_state, only: history_variable
  use amontons_constraints, only: condense_forces
  use amontons_result_schema, only: field_rows, POINT_COLUMNS, N_POINT_REALS, N_POINT_INTEGERS, STRAIN_COLUMN, &
    PAIR_COLUMNS, N_PAIR_REALS, N_PAIR_INTEGERS
  use amontons_postprocess, only: nodal_slaves
  use amontons_nodal_fields, only: select_all_nodes, point_fields
  use amontons_results, only: pair_rows
  use amontons_analysis, only: analysis_type, is_at_end
  use amontons_driven_loads, only: set_driven, set_friction, friction_now, current_loads, DRIVEN_FORCE, &
    DRIVEN_DISPLACEMENT, DRIVEN_PRESSURE, &
    DRIVEN_TEMPERATURE
  implicit none
  private
  public :: query_values, set_driven_values, query_names, current_step, time_in_step, time_left_in_step

  !> Quantities of query_values besides the nodal columns of the result file, for query_names.
  character(16), parameter :: NUMBER_QUANTITIES(*) = [character(16) :: 'TIME', 'STEP TIME', 'TIME LEFT', 'STEP', 'INCREMENTS', &
    'ITERATIONS', &
    'LOAD FACTOR', 'IMBALANCE', 'EXTERNAL WORK', 'FRICTION WORK', 'DAMPED WORK', 'STRAIN ENERGY', 'FRICTION']
  character(16), parameter :: FIELD_QUANTITIES(*) = [character(16) :: 'NODES', 'X', 'INTERNAL FORCE', 'APPLIED FORCE', &
    'CONTACT FORCE', 'RESIDUAL', 'CF', 'CF1', 'CF2', 'CF3', 'P', 'FACE CENTRES']
  character(16), parameter :: POINT_QUANTITIES(*) = [character(16) :: 'ELEMENT LABEL', 'POINT LABEL', 'POINT VOLUME', 'POINT S', &
    'POINT E', 'POINT ENERGY', 'POINT PEEQ', 'POINT SDV', 'ELEMENT VOLUME', 'ELEMENT S', 'ELEMENT E', 'ELEMENT ENERGY', &
    'ELEMENT PEEQ', 'ELEMENT SDV']
  integer, parameter :: PAIR_SUMS(*) = [6, 7, 8, 9, 10, 11, 12]   !< the sums among PAIR_COLUMNS: after the counts and the time

contains

  !> A quantity by name, one column per row of the set. The names are in doc/manual/library.md.
  !!
  !! Before: the job has started. Errors: EXIT_USAGE.
  subroutine query_values(analysis, quantity, set, values, error)
    type(analysis_type), intent(in) :: analysis
    character(*), intent(in) :: quantity           !< e.g. 'U', 'CPRESS', 'POINT S', 'TIME'
    character(*), intent(in) :: set                !< node set, surface, element set, label; '' means all
    real(DP), allocatable, intent(out) :: values(:, :)   !< (components, rows)
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: nodes(:)
    logical :: is_known
    call get_number(analysis, name_key(quantity), set, values, is_known, error)
    if (.not. (is_known .or. allocated(error))) call get_of_elements(analysis, name_key(quantity), set, values, is_known, error)
    if (.not. (is_known .or. allocated(error))) call get_of_pairs(analysis, name_key(quantity), set, values, is_known, error)
    if (is_known .or. allocated(error)) return
    select case (name_key(quantity))
    case ('FACECENTRES')
      call get_face_centres(analysis, set, values, error)
      return
    case ('CF', 'CF1', 'CF2', 'CF3', 'P')
      call get_loads(analysis, name_key(quantity), set, values, error)
      return
    end select
    call find_nodes(analysis, set, nodes, error)
    if (allocated(error)) return
    call get_vector(analysis, name_key(quantity), nodes, values, is_known)
    if (.not. is_known) call get_column(analysis, name_key(quantity), nodes, values, is_known)
    if (.not. is_known) call set_error(error, EXIT_USAGE, 'There is no quantity named ' // quantity // &
      suggestion(analysis, [character(10) :: 'QUANTITIES'], quantity))
  end subroutine query_values


  !> The names of a kind in a job: NODE SETS, ELEMENT SETS, SURFACES, PAIRS, INTERACTIONS, MATERIALS, and the
  !! QUANTITIES of query_values. Errors: EXIT_USAGE.
  subroutine query_names(analysis, kind, names, error)
    type(analysis_type), intent(in) :: analysis
    character(*), intent(in) :: kind
    character(:), allocatable, intent(out) :: names(:)
    type(error_type), allocatable, intent(out) :: error
    integer, parameter :: LENGTH = 4 * NAME_LENGTH + 5   ! of a pair: twice the name of an instance, a point, the name of a surface
    integer :: i
    associate (model => analysis%model, mesh => analysis%model%mesh)
      select case (name_key(kind))
      case ('NODESETS')
        allocate (character(LENGTH) :: names(size(mesh%node_sets)))
        do i = 1, size(names)
          names(i) = mesh%node_sets(i)%name
        end do
      case ('ELEMENTSETS')
        allocate (character(LENGTH) :: names(size(mesh%element_sets)))
        do i = 1, size(names)
          names(i) = mesh%element_sets(i)%name
        end do
      case ('SURFACES')
        allocate (character(LENGTH) :: names(size(model%surfaces)))
        do i = 1, size(names)
          names(i) = model%surfaces(i)%name
        end do
      case ('PAIRS')
        allocate (character(LENGTH) :: names(size(model%pairs)))
        do i = 1, size(names)
          names(i) = model%pairs(i)%name
        end do
      case ('INTERACTIONS')
        allocate (character(LENGTH) :: names(size(model%interactions)))
        do i = 1, size(names)
          names(i) = model%interactions(i)%name
        end do
      case ('MATERIALS')
        allocate (character(LENGTH) :: names(size(model%materials)))
        do i = 1, size(names)
          names(i) = model%materials(i)%name
        end do
      case ('QUANTITIES')
        names = [character(LENGTH) :: NUMBER_QUANTITIES, FIELD_QUANTITIES, POINT_COLUMNS%name, &
          pack(POINT_QUANTITIES, index(POINT_QUANTITIES, ' SDV') == 0 .or. any(model%materials%n_statev > 0)), &
          PAIR_COLUMNS(PAIR_SUMS)%name]
      case default
        call set_error(error, EXIT_USAGE, 'There are no names of ' // kind // '; NODE SETS, ELEMENT SETS, SURFACES, ' // &
          'PAIRS, INTERACTIONS, MATERIALS and QUANTITIES have some.')
      end select
    end associate
  end subroutine query_names


  !> A single number.
  subroutine get_number(analysis, quantity, set, values, is_known, error)
    type(analysis_type), intent(in) :: analysis
    character(*), intent(in) :: quantity           !< squeezed
    character(*), intent(in) :: set
    real(DP), allocatable, intent(out) :: values(:, :)
    logical, intent(out) :: is_known
    type(error_type), allocatable, intent(out) :: error
    real(DP) :: value
    integer :: i
    is_known = .true.
    associate (new => analysis%state%new)
      select case (quantity)
      case ('TIME')
        value = new%total_time
      case ('LOADFACTOR')
        value = new%load_factor
      case ('STEPTIME')
        value = new%step_time
      case ('TIMELEFT')
        value = merge(0.0_DP, time_left_in_step(analysis), is_at_end(analysis))
      case ('STEP')
        value = real(analysis%stepping%step, DP)
      case ('INCREMENTS')
        value = real(count(analysis%records(:analysis%n_records)%is_converged), DP)
      case ('ITERATIONS')
        value = real(sum(analysis%records(:analysis%n_records)%n_iterations), DP)
      case ('IMBALANCE')
        value = max(analysis%newton%measures%residual(0), analysis%newton%measures%residual_at_gap)
      case ('EXTERNALWORK')
        value = new%external_work
      case ('FRICTIONWORK')
        value = new%friction_work
      case ('DAMPEDWORK')
        value = new%stabilization_work
      case ('STRAINENERGY')
        value = 0.0_DP
        if (allocated(new%energy)) value = sum(new%energy * new%volume)
      case ('FRICTION')
        call find_interaction(analysis, set, i, error)
        if (allocated(error)) return
        value = friction_now(analysis%driven_loads, analysis%model, i)
      case default
        is_known = .false.
        return
      end select
    end associate
    values = reshape([value], [1, 1])
  end subroutine get_number


  !> Sums over contact pairs: a column of the history of pairs of the result file.
  subroutine get_of_pairs(analysis, quantity, set, values, is_known, error)
    type(analysis_type), intent(in) :: analysis
    character(*), intent(in) :: quantity           !< squeezed
    character(*), intent(in) :: set                !< 'slave / master', or the slave surface of one pair; '' means all pairs
    real(DP), allocatable, intent(out) :: values(:, :)   !< (components, pairs)
    logical, intent(out) :: is_known
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: reals(:, :)
    integer, allocatable :: integers(:, :), pairs(:)
    integer :: i, column, first
    column = 0
    do i = 1, size(PAIR_SUMS)
      if (name_key(PAIR_COLUMNS(PAIR_SUMS(i))%name) == quantity) column = PAIR_SUMS(i)
    end do
    is_known = column > 0
    if (.not. is_known) return
    call find_pairs(analysis, set, pairs, error)
    if (allocated(error)) return
    associate (model => analysis%model)
      allocate (integers(N_PAIR_INTEGERS, size(model%pairs)), reals(N_PAIR_REALS, size(model%pairs)))
      call pair_rows(model, analysis%state%new, [0, 0], analysis%state%new%total_time, integers, reals)
    end associate
    first = sum(PAIR_COLUMNS(:column - 1)%width, mask=.not. PAIR_COLUMNS(:column - 1)%is_integer)
    values = reals(first + 1:first + PAIR_COLUMNS(column)%width, pairs)
  end subroutine get_of_pairs


  !> The contact pair of a name or of a slave surface; '' means all.
  subroutine find_pairs(analysis, set, pairs, error)
    type(analysis_type), intent(in) :: analysis
    character(*), intent(in) :: set
    integer, allocatable, intent(out) :: pairs(:)
    type(error_type), allocatable, intent(out) :: error
    logical, allocatable :: is_wanted(:)
    integer :: i
    associate (model => analysis%model)
      allocate (is_wanted(size(model%pairs)), source=len_trim(set) == 0)
      do i = 1, size(model%pairs)
        if (name_key(model%pairs(i)%name) == name_key(set)) is_wanted(i) = .true.
      end do
      if (.not. any(is_wanted)) then
        do i = 1, size(model%pairs)
          is_wanted(i) = name_key(model%surfaces(model%pairs(i)%slave)%name) == name_key(set)
        end do
        if (count(is_wanted) > 1) then
          call set_error(error, EXIT_USAGE, set // ' is the slave of several contact pairs; name one as "slave / master".')
          return
        end if
      end if
      pairs = pack([(i, i=1, size(model%pairs))], is_wanted)
    end associate
    if (size(pairs) == 0 .and. len_trim(set) > 0) call set_error(error, EXIT_USAGE, 'There is no contact pair named ' // set // &
      suggestion(analysis, [character(10) :: 'PAIRS'], set))
  end subroutine find_pairs


  !> The end of a sentence about an unknown name: the nearest of the names of some kinds as the deck has
  !! it, all of a few, or a full stop.
  function suggestion(analysis, kinds, name) result(text)
    type(analysis_type), intent(in) :: analysis
    character(*), intent(in) :: kinds(:)           !< of query_names
    character(*), intent(in) :: name               !< unknown
    character(:), allocatable :: text
    character(:), allocatable :: names(:)
    type(name_table_type) :: table
    type(error_type), allocatable :: error
    integer :: i, k, best, position
    logical :: is_new
    do k = 1, size(kinds)
      call query_names(analysis, trim(kinds(k)), names, error)
      do i = 1, size(names)
        call table%add(trim(names(i)), position, is_new)
      end do
    end do
    text = table%suggest(name)
    best = table%nearest(name)
    do k = 1, size(kinds)
      call query_names(analysis, trim(kinds(k)), names, error)
      do i = 1, size(names)
        if (best > 0 .and. table%find(names(i)) == best) text = '; did you mean ' // trim(names(i)) // '?'
      end do
    end do
  end function suggestion


  !> The centres of the faces of a surface (means of their corners), in the order in which P is set.
  subroutine get_face_centres(analysis, set, values, error)
    type(analysis_type), intent(in) :: analysis
    character(*), intent(in) :: set                !< surface
    real(DP), allocatable, intent(out) :: values(:, :)   !< (3, faces) [length]
    type(error_type), allocatable, intent(out) :: error
    type(element_kind_type) :: entry
    type(facet_kind_type) :: facet
    integer :: i, k, e, surface, corners(4)
    surface = surface_of(analysis, set)
    if (surface == 0) then
      call set_error(error, EXIT_USAGE, 'There is no surface named ' // set // &
          suggestion(analysis, [character(10) :: 'SURFACES'], set))
      return
    end if
    associate (faces => analysis%model%surfaces(surface), mesh => analysis%model%mesh)
      allocate (values(3, size(faces%element)))
      do i = 1, size(faces%element)
        e = faces%element(i)
        entry = element_kind(mesh%kind(e))
        facet = facet_kind(entry%face_kind(faces%face(i)))
        k = facet%n_corners
        corners(:k) = mesh%nodes(mesh%first(e) - 1 + entry%face_nodes(:k, faces%face(i)))
        values(:, i) = sum(mesh%coordinates(:, corners(:k)), dim=2) / real(k, DP)
      end do
    end associate
  end subroutine get_face_centres


  !> A vector at nodes, or their labels.
  subroutine get_vector(analysis, quantity, nodes, values, is_known)
    type(analysis_type), intent(in) :: analysis
    character(*), intent(in) :: quantity           !< squeezed
    integer, intent(in) :: nodes(:)
    real(DP), allocatable, intent(out) :: values(:, :)
    logical, intent(out) :: is_known
    real(DP), allocatable :: whole(:, :)
    is_known = .true.
    associate (mesh => analysis%model%mesh, new => analysis%state%new)
      select case (quantity)
      case ('NODES')
        values = reshape(real(mesh%node_label(nodes), DP), [1, size(nodes)])
      case ('X')
        values = mesh%coordinates(:, nodes)
      case ('NT', 'TEMPERATURE')
        values = reshape(new%temperature(nodes), [1, size(nodes)])
      case ('INTERNALFORCE')
        values = new%internal_force(:, nodes)
      case ('APPLIEDFORCE')
        values = new%applied_force(:, nodes)
      case ('CONTACTFORCE')
        values = new%contact_force(:, nodes)
      case ('RESIDUAL')
        whole = new%internal_force
        call condense_forces(analysis%system%base, new%applied_force + new%contact_force - new%internal_force, whole)
        values = whole(:, nodes)
      case default
        is_known = .false.
      end select
    end associate
  end subroutine get_vector


  !> A column of the point data of the result file.
  subroutine get_column(analysis, quantity, nodes, values, is_known)
    type(analysis_type), intent(in) :: analysis
    character(*), intent(in) :: quantity           !< squeezed
    integer, intent(in) :: nodes(:)
    real(DP), allocatable, intent(out) :: values(:, :)
    logical, intent(out) :: is_known
    real(DP), allocatable :: reals(:, :)
    integer, allocatable :: integers(:, :)
    integer :: i, rows(2)
    is_known = .false.
    do i = 1, size(POINT_COLUMNS)
      is_known = name_key(POINT_COLUMNS(i)%name) == quantity .or. (i == STRAIN_COLUMN .and. quantity == 'LE')
      if (is_known) exit
    end do
    if (.not. is_known) return
    rows = field_rows(POINT_COLUMNS(i)%name)
    associate (model => analysis%model)
      allocate (reals(N_POINT_REALS, model%mesh%n_nodes), integers(N_POINT_INTEGERS, model%mesh%n_nodes))
      call point_fields(model, select_all_nodes(model%mesh), analysis%state%new, nodal_slaves(model, analysis%state%new%slaves), &
        mesh_extent(model%mesh), reals, integers)
    end associate
    if (POINT_COLUMNS(i)%is_integer) then
      values = real(integers(rows(1):rows(2), nodes), DP)
    else
      values = reals(rows(1):rows(2), nodes)
    end if
  end subroutine get_column


  !> Forces on nodes or pressures on faces, of the deck or set by the caller, at the current time.
  subroutine get_loads(analysis, quantity, set, values, error)
    type(analysis_type), intent(in) :: analysis
    character(*), intent(in) :: quantity           !< squeezed: P, CF, CF1, CF2, CF3
    character(*), intent(in) :: set
    real(DP), allocatable, intent(out) :: values(:, :)   !< (components, rows) [force] or [stress]
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: items(:)
    integer :: kind, width
    call find_items(analysis, quantity, set, kind, items, error)
    if (allocated(error)) return
    width = merge(3, 1, quantity == 'CF')
    associate (model => analysis%model, new => analysis%state%new)
      values = reshape(current_loads(analysis%driven_loads, model, max(1, analysis%stepping%step), kind, items, &
        [new%total_time, new%step_time]), [width, size(items) / width])
    end associate
  end subroutine get_loads


  !> Values at integration points (POINT ...), their mean over the reference volume of each element (ELEMENT ...); LABEL
  !! is that of the element.
  subroutine get_of_elements(analysis, quantity, set, values, is_known, error)
    type(analysis_type), intent(in) :: analysis
    character(*), intent(in) :: quantity           !< squeezed
    character(*), intent(in) :: set                !< element set, label of an element; '' means all
    real(DP), allocatable, intent(out) :: values(:, :)   !< (components, points or elements)
    logical, intent(out) :: is_known
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: table(:, :)
    integer, allocatable :: elements(:)
    integer :: i, p
    logical :: is_mean
    is_mean = index(quantity, 'ELEMENT') == 1
    is_known = is_mean .or. index(quantity, 'POINT') == 1
    if (is_known) call get_of_points(analysis, quantity(merge(8, 6, is_mean):), table, is_known)
    if (.not. is_known) return
    call find_elements(analysis, set, elements, error)
    if (allocated(error)) return
    associate (mesh => analysis%model%mesh, first => analysis%model%mesh%point_first)
      if (quantity == 'ELEMENTLABEL') then
        values = reshape(real(mesh%element_label(elements), DP), [1, size(elements)])
      else if (is_mean) then
        allocate (values(size(table, 1), size(elements)))
        do i = 1, size(elements)
          associate (rows => table(:, first(elements(i)):first(elements(i) + 1) - 1), &
            volume => analysis%state%new%volume(first(elements(i)):first(elements(i) + 1) - 1))
            values(:, i) = merge(sum(rows, dim=2), mean_of(rows, volume), quantity == 'ELEMENTVOLUME')
          end associate
        end do
      else
        values = table(:, [((p, p=first(elements(i)), first(elements(i) + 1) - 1), i=1, size(elements))])
      end if
    end associate
  end subroutine get_of_elements


  !> Weighted mean of the columns of a table; the plain mean if no weight is positive.
  pure function mean_of(rows, weight) result(mean)
    real(DP), intent(in) :: rows(:, :)             !< (components, n)
    real(DP), intent(in) :: weight(:)              !< (n)
    real(DP) :: mean(size(rows, 1))
    mean = 0
    if (size(weight) == 0) return
    mean = sum(rows, dim=2) / real(size(weight), DP)
    if (sum(weight) > 0.0_DP) mean = matmul(rows, weight) / sum(weight)
  end function mean_of


  !> A quantity at all integration points.
  subroutine get_of_points(analysis, quantity, table, is_known)
    type(analysis_type), intent(in) :: analysis
    character(*), intent(in) :: quantity           !< squeezed, without POINT or ELEMENT
    real(DP), allocatable, intent(out) :: table(:, :)   !< (components, n_points)
    logical, intent(out) :: is_known
    integer :: e
    is_known = .true.
    associate (new => analysis%state%new, mesh => analysis%model%mesh)
      select case (quantity)
      case ('LABEL')
        allocate (table(1, mesh%n_points))
        do e = 1, mesh%n_elements
          table(1, mesh%point_first(e):mesh%point_first(e + 1) - 1) = real(mesh%element_label(e), DP)
        end do
      case ('S')
        table = new%stress
      case ('E', 'LE')
        table = new%strain
      case ('ENERGY')
        table = reshape(new%energy, [1, mesh%n_points])
      case ('VOLUME')
        table = reshape(new%volume, [1, mesh%n_points])
      case ('PEEQ')
        table = reshape(history_variable(new, HISTORY_PEEQ), [1, mesh%n_points])
      case ('SDV')
        is_known = size(new%history, 1) >= USER_STATE .and. any(analysis%model%materials%n_statev > 0)
        if (is_known) table = new%history(USER_STATE:USER_STATE + maxval(analysis%model%materials%n_statev) - 1, :)
      case default
        is_known = .false.
      end select
    end associate
  end subroutine get_of_points


  !> The elements of an element set or of a label; '' means all.
  subroutine find_elements(analysis, set, elements, error)
    type(analysis_type), intent(in) :: analysis
    character(*), intent(in) :: set
    integer, allocatable, intent(out) :: elements(:)
    type(error_type), allocatable, intent(out) :: error
    integer :: i, label, status
    associate (mesh => analysis%model%mesh)
      if (len_trim(set) == 0) then
        elements = [(i, i=1, mesh%n_elements)]
        return
      end if
      do i = 1, size(mesh%element_sets)
        if (name_key(mesh%element_sets(i)%name) /= name_key(set)) cycle
        elements = mesh%element_sets(i)%members
        return
      end do
      call parse_integer(set, label, status)
      i = 0
      if (status == NUMBER_OK) i = findloc(mesh%element_label, label, dim=1)
      if (i > 0) elements = [i]
      if (i == 0) call set_error(error, EXIT_USAGE, 'There is no element set or element named ' // set // &
        suggestion(analysis, [character(12) :: 'ELEMENT SETS'], set))
    end associate
  end subroutine find_elements


  !> Sets a quantity: FRICTION of an interaction; P of a surface; NT, CF, CF1 to CF3, U, U1 to U3 of a node set. One value
  !! per component for all rows, or one per component and row. The value is reached at the end of the increments solved next
  !! (manual).
  subroutine set_driven_values(analysis, quantity, set, values, error)
    type(analysis_type), intent(inout) :: analysis
    character(*), intent(in) :: quantity
    character(*), intent(in) :: set                !< node set, surface, label of a node, or interaction
    real(DP), intent(in) :: values(:)              !< component by component of each row
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: items(:)
    integer :: kind
    if (.not. all(abs(values) <= huge(1.0_DP))) then
      call set_error(error, EXIT_USAGE, 'A value of ' // quantity // ' is not a finite number.')
      return
    end if
    if (name_key(quantity) == 'FRICTION') then
      call set_driven_friction(analysis, set, values, error)
      return
    end if
    call find_items(analysis, name_key(quantity), set, kind, items, error)
    if (allocated(error)) return
    if (size(items) == 0) return
    call set_driven_items(analysis, kind, items, quantity, values, error)
  end subroutine set_driven_values


  !> Sets the coefficient of friction of an interaction.
  subroutine set_driven_friction(analysis, set, values, error)
    type(analysis_type), intent(inout) :: analysis
    character(*), intent(in) :: set                !< interaction
    real(DP), intent(in) :: values(:)              !< one [-]
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    call find_interaction(analysis, set, i, error)
    if (allocated(error)) return
    if (size(values) /= 1) then
      call set_error(error, EXIT_USAGE, plural(size(values), 'value') // ' of FRICTION ' // &
        verb(size(values), 'was', 'were') // ' given; it takes 1.')
    else if (values(1) < 0.0_DP) then
      call set_error(error, EXIT_USAGE, 'A coefficient of friction must not be negative.')
    else
      call set_friction(analysis%driven_loads, analysis%model, i, values(1))
    end if
  end subroutine set_driven_friction


  !> Sets the values of the items: one for all, one per component, or one per item.
  subroutine set_driven_items(analysis, kind, items, quantity, values, error)
    type(analysis_type), intent(inout) :: analysis
    integer, intent(in) :: kind                    !< DRIVEN_...
    integer, intent(in) :: items(:)
    character(*), intent(in) :: quantity
    real(DP), intent(in) :: values(:)
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: now(:)
    integer :: width, i
    width = 1
    if (kind /= DRIVEN_PRESSURE .and. kind /= DRIVEN_TEMPERATURE .and. &
      len(name_key(quantity)) == merge(2, 1, kind == DRIVEN_FORCE)) width = 3
    if (size(values) /= width .and. size(values) /= size(items)) then
      call set_error(error, EXIT_USAGE, plural(size(values), 'value') // ' of ' // quantity // &
        verb(size(values), ' was', ' were') // ' given; it takes ' // to_text(width) // ' or ' // to_text(size(items)) // '.')
      return
    end if
    now = [analysis%stepping%total_time, time_in_step(analysis)]
    if (kind == DRIVEN_TEMPERATURE) now = [now, analysis%snapshot%fields%temperature(items)]
    if (kind == DRIVEN_DISPLACEMENT) now = [now, [(analysis%snapshot%fields%u(mod(items(i) - 1, 3) + 1, &
      (items(i) + 2) / 3), i=1, size(items))]]
    call set_driven(analysis%driven_loads, analysis%model, current_step(analysis), kind, items, &
      [(values(mod(i - 1, size(values)) + 1), i=1, size(items))], now, error)
  end subroutine set_driven_items


  !> Finds kind and items of amontons_driven_loads for a quantity and a set.
  subroutine find_items(analysis, quantity, set, kind, items, error)
    type(analysis_type), intent(in) :: analysis
    character(*), intent(in) :: quantity           !< squeezed
    character(*), intent(in) :: set
    integer, intent(out) :: kind                   !< DRIVEN_...
    integer, allocatable, intent(out) :: items(:)
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: nodes(:)
    integer :: i, dof, surface
    kind = DRIVEN_FORCE
    if (quantity == 'P') then
      kind = DRIVEN_PRESSURE
      surface = surface_of(analysis, set)
      if (surface == 0) then
        call set_error(error, EXIT_USAGE, 'There is no surface named ' // set // &
          suggestion(analysis, [character(10) :: 'SURFACES'], set))
      else
        items = 6 * (analysis%model%surfaces(surface)%element - 1) + analysis%model%surfaces(surface)%face
      end if
      return
    end if
    if (quantity == 'NT' .or. quantity == 'TEMPERATURE') then
      kind = DRIVEN_TEMPERATURE
      call find_nodes(analysis, set, items, error)
      return
    end if
    dof = findloc(['CF ', 'CF1', 'CF2', 'CF3'] == quantity, .true., dim=1) - 1
    if (dof < 0) then
      kind = DRIVEN_DISPLACEMENT
      dof = findloc(['U ', 'U1', 'U2', 'U3'] == quantity, .true., dim=1) - 1
    end if
    if (dof < 0) then
      call set_error(error, EXIT_USAGE, 'The quantity ' // quantity // ' cannot be set; FRICTION, NT, P, CF, CF1 to CF3, ' // &
        'U, U1 to U3 can.')
      return
    end if
    call find_nodes(analysis, set, nodes, error)
    if (allocated(error)) return
    if (dof > 0) items = 3 * (nodes - 1) + dof
    if (dof == 0) items = [([3 * nodes(i) - 2, 3 * nodes(i) - 1, 3 * nodes(i)], i=1, size(nodes))]
  end subroutine find_items


  !> The nodes of a node set, of a surface, or of a label; '' means all.
  subroutine find_nodes(analysis, set, nodes, error)
    type(analysis_type), intent(in) :: analysis
    character(*), intent(in) :: set
    integer, allocatable, intent(out) :: nodes(:)
    type(error_type), allocatable, intent(out) :: error
    integer :: i, label, status
    associate (model => analysis%model, mesh => analysis%model%mesh)
      if (len_trim(set) == 0) then
        nodes = [(i, i=1, mesh%n_nodes)]
        return
      end if
      do i = 1, size(mesh%node_sets)
        if (name_key(mesh%node_sets(i)%name) /= name_key(set)) cycle
        nodes = mesh%node_sets(i)%members
        return
      end do
      i = surface_of(analysis, set)
      if (i > 0) then
        nodes = model%surfaces(i)%nodes
        return
      end if
      call parse_integer(set, label, status)
      i = 0
      if (status == NUMBER_OK) i = findloc(mesh%node_label, label, dim=1)
      if (i > 0) nodes = [i]
      if (i == 0) call set_error(error, EXIT_USAGE, 'There is no node set, surface or node named ' // set // &
        suggestion(analysis, [character(10) :: 'NODE SETS', 'SURFACES'], set))
    end associate
  end subroutine find_nodes


  !> Index of a surface; 0: not found.
  pure integer function surface_of(analysis, name) result(i)
    type(analysis_type), intent(in) :: analysis
    character(*), intent(in) :: name
    do i = 1, size(analysis%model%surfaces)
      if (name_key(analysis%model%surfaces(i)%name) == name_key(name)) return
    end do
    i = 0
  end function surface_of


  !> Index of an interaction; '' selects the only one.
  subroutine find_interaction(analysis, name, i, error)
    type(analysis_type), intent(in) :: analysis
    character(*), intent(in) :: name
    integer, intent(out) :: i
    type(error_type), allocatable, intent(out) :: error
    associate (interactions => analysis%model%interactions)
      i = 1
      if (len_trim(name) == 0 .and. size(interactions) == 1) return
      do i = 1, size(interactions)
        if (name_key(interactions(i)%name) == name_key(name)) return
      end do
    end associate
    call set_error(error, EXIT_USAGE, 'There is no interaction named ' // name // &
      suggestion(analysis, [character(12) :: 'INTERACTIONS'], name))
  end subroutine find_interaction


  !> Index of the step of the next increment.
  pure integer function current_step(analysis) result(i_step)
    type(analysis_type), intent(in) :: analysis
    i_step = max(1, analysis%stepping%step)
    if (.not. analysis%is_step_start .or. analysis%stepping%step_time == 0.0_DP) return
    i_step = min(i_step + 1, size(analysis%model%steps))
  end function current_step


  !> Time within the step of the next increment [time].
  pure real(DP) function time_in_step(analysis) result(time)
    type(analysis_type), intent(in) :: analysis
    time = merge(0.0_DP, analysis%stepping%step_time, analysis%is_step_start)
  end function time_in_step


  !> Time left in the step of the next increment [time].
  pure real(DP) function time_left_in_step(analysis) result(time)
    type(analysis_type), intent(in) :: analysis
    time = analysis%model%steps(current_step(analysis))%period - time_in_step(analysis)
    if (analysis%model%steps(current_step(analysis))%is_riks) time = time + time_in_step(analysis)   ! a path has no known end
  end function time_left_in_step

end module amontons_job_query
