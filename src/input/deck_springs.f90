!> SPRING, GAP, MASS and MPC DIST to element laws.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! *MPC, DIST is an inequality constraint, which elimination cannot represent. A rope therefore is a spring far stiffer than the
!! bodies at its ends: its elongation is its force over 1e4 E L, with the initial length L.
module amontons_deck_springs
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type, next_row
  use amontons_card_schema, only: has_parameter, parameter_text
  use amontons_deck_couplings, only: find_orientation
  use amontons_deck_mesh, only: count_rows, is_in_family
  use amontons_element_drafts, only: element_draft_type, resize_draft, NOT_GIVEN
  use amontons_deck_reader, only: reader_type, open_card, report_error, report_note, read_real, read_integer, check_n_fields, &
    check_no_data, &
    is_card
  use amontons_materials, only: spring_type, hardening_curve_type
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_text, only: to_text, plural
  use amontons_mpc_data, only: coordinate_system_type, axes_at
  use amontons_element_kinds, only: KIND_SPRING1, KIND_SPRING2, KIND_GAPUNI, FAMILY_SPRING, &
    FAMILY_MASS, is_of_revolution, KIND_SPRINGA, N_CIRCLE_SECTORS
  use amontons_deck_mpc, only: read_next_mpc, unique_nodes
  implicit none
  private
  public :: read_springs
  public :: read_distance_limits, stiffen_springs_on_rings

  real(DP), parameter :: LIMIT_STIFFNESS_FACTOR = 1.0e4_DP        !< than a cube of the stiffest material, as long as the rope [-]

contains

  !> Reads all SPRING, GAP and MASS cards: element to constant and directions, or to a law.
  subroutine read_springs(reader, model, draft)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model     !< with the element sets of drafts
    type(element_draft_type), intent(inout) :: draft
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    character(8), parameter :: CARDS(3) = [character(8) :: 'SPRING', 'GAP', 'MASS']
    integer :: c, set, e, k
    allocate (model%springs(0))
    do e = 1, draft%n
      if (is_in_family(draft%kind(e), FAMILY_SPRING) .or. is_in_family(draft%kind(e), &
        FAMILY_MASS)) draft%section_value(e) = NOT_GIVEN
    end do
    do c = 1, reader%cards%n_cards
      do k = 1, size(CARDS)
        if (is_card(reader, c, trim(CARDS(k)))) exit
      end do
      if (k > size(CARDS)) cycle
      call open_card(reader, c, parameters, row)
      set = reader%element_sets%find(parameter_text(parameters, 'ELSET'))
      if (set == 0) then
        call report_error(reader, reader%cards%cards(c)%line, 'There is no element set ''' // &
          parameter_text(parameters, 'ELSET') // '''.')
        cycle
      end if
      associate (members => model%mesh%element_sets(set)%members)
        if (.not. check_member_kinds(reader, draft, c, members, trim(CARDS(k)))) cycle
        draft%section_card(members) = c
        draft%section_value(members) = 1               ! named by a card, whatever its data are worth
        select case (k)
        case (1)
          call read_spring(reader, model, c, members, draft)
        case (2)
          call read_gap_element(reader, model, c, members, draft)
        case (3)
          call read_mass(reader, c, members, row, draft)
        end select
      end associate
    end do
  end subroutine read_springs


  !> Springs at nodes of axisymmetric elements act on two degrees of the circle in CalculiX, so on the full one they are
  !! N_CIRCLE_SECTORS times as stiff.
  subroutine stiffen_springs_on_rings(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    logical :: is_on_ring(model%mesh%n_nodes)
    integer :: e, kind, n, first, stiffer(size(model%springs))   ! the stiffer copy of a law; 0
    if (reader%dialect /= DIALECT_CALCULIX) return
    is_on_ring = .false.
    kind = 0
    n = 0
    first = 0
    stiffer = 0
    associate (mesh => model%mesh)
      do e = 1, mesh%n_elements
        if (is_of_revolution(mesh%kind(e))) is_on_ring(mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1)) = .true.
      end do
      do e = 1, mesh%n_elements
        if (.not. any(mesh%kind(e) == [KIND_SPRINGA, KIND_SPRING1, KIND_SPRING2])) cycle
        if (.not. any(is_on_ring(mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1))) .or. is_rope(e)) cycle
        n = n + 1
        if (n == 1) first = mesh%element_label(e)
        mesh%section_value(e) = N_CIRCLE_SECTORS * mesh%section_value(e)
        if (.not. allocated(mesh%spring)) cycle
        if (mesh%spring(e) == 0) cycle
        if (stiffer(mesh%spring(e)) == 0) then
          model%springs = [model%springs, stiffer_law(model%springs(mesh%spring(e)))]
          stiffer(mesh%spring(e)) = size(model%springs)
        end if
        mesh%spring(e) = stiffer(mesh%spring(e))
      end do
    end associate
    if (n > 0) call report_note(reader, 0, 'Springs at nodes of axisymmetric elements (' // plural(n, 'spring') // &
      ', the first is element ' // to_text(first) // ') act on two degrees of the circle, as in CalculiX: on the full ' // &
      'circle they are ' // to_text(N_CIRCLE_SECTORS) // ' times as stiff.')

  contains

    !> Whether an element is one of *MPC, DIST.
    pure logical function is_rope(e)
      integer, intent(in) :: e
      is_rope = .false.
      if (.not. allocated(model%mesh%spring)) return
      if (model%mesh%spring(e) > 0) is_rope = model%springs(model%mesh%spring(e))%is_distance_limit
    end function is_rope

  end subroutine stiffen_springs_on_rings


  !> A law with N_CIRCLE_SECTORS times the forces.
  pure function stiffer_law(law) result(stiffer)
    type(spring_type), intent(in) :: law
    type(spring_type) :: stiffer
    integer :: i
    stiffer = law
    if (allocated(law%constant%value)) stiffer%constant%value = N_CIRCLE_SECTORS * law%constant%value
    if (allocated(law%force)) then
      do i = 1, size(law%force)
        stiffer%force(i)%stress = N_CIRCLE_SECTORS * law%force(i)%stress
      end do
    end if
  end function stiffer_law


  !> Whether all members of a set are of the kinds of a card; reports the first that is not.
  logical function check_member_kinds(reader, draft, c, members, card)
    type(reader_type), intent(inout) :: reader
    type(element_draft_type), intent(in) :: draft
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: members(:)            !< drafts
    character(*), intent(in) :: card             !< SPRING, GAP or MASS
    character(:), allocatable :: what
    integer :: i
    logical :: is_so
    check_member_kinds = .false.
    do i = 1, size(members)
      associate (kind => draft%kind(members(i)))
        select case (card)
        case ('SPRING')
          is_so = is_in_family(kind, FAMILY_SPRING) .and. kind /= KIND_GAPUNI
          what = 'spring'
        case ('GAP')
          is_so = kind == KIND_GAPUNI
          what = 'gap of type GAPUNI'
        case default
          is_so = is_in_family(kind, FAMILY_MASS)
          what = 'mass'
        end select
      end associate
      if (is_so) cycle
      call report_error(reader, reader%cards%cards(c)%line, 'The element ' // to_text(draft%label(members(i))) // ' is no ' // &
        what // '.')
      return
    end do
    check_member_kinds = .true.
  end function check_member_kinds


  !> MASS: one number.
  subroutine read_mass(reader, c, members, row, draft)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: members(:)            !< drafts
    type(data_row_type), intent(inout) :: row
    type(element_draft_type), intent(inout) :: draft
    real(DP) :: mass
    logical :: is_ok
    is_ok = next_row(reader%cards, row)
    if (.not. is_ok) then
      call report_error(reader, reader%cards%cards(c)%line, 'The data are missing: the mass.')
      return
    end if
    call read_real(reader, row, 1, 'mass', mass, is_ok)
    if (is_ok) draft%section_value(members) = mass
    if (next_row(reader%cards, row)) call check_no_data(reader, row)
  end subroutine read_mass


  !> SPRING: directions of SPRING1 and SPRING2, then constant over temperature, or with NONLINEAR force, elongation, temperature.
  subroutine read_spring(reader, model, c, members, draft)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: members(:)            !< drafts
    type(element_draft_type), intent(inout) :: draft
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(spring_type) :: spring
    integer :: n, directions(2)
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    n = 0                                        ! directions to read
    if (any(draft%kind(members) == KIND_SPRING1)) n = 1
    if (any(draft%kind(members) == KIND_SPRING2)) n = 2
    directions = 0
    is_ok = .true.
    if (n > 0) then
      if (next_row(reader%cards, row)) call read_directions(reader, row, n, directions, is_ok)
      if (.not. is_ok) return
    end if
    if (has_parameter(parameters, 'NONLINEAR')) then
      call read_force_curves(reader, row, spring%force, is_ok)
    else
      call read_spring_constants(reader, row, spring, is_ok)
    end if
    if (.not. is_ok) then
      call report_error(reader, reader%cards%cards(c)%line, 'The data are missing: directions (SPRING1, SPRING2), then the ' // &
        'spring constant, or with NONLINEAR lines of force and elongation.')
      return
    end if
    draft%directions(:, members) = spread(directions, 2, size(members))
    if (has_parameter(parameters, 'ORIENTATION') .and. n > 0) then
      call set_spring_axes(reader, c, parameters, n, directions, spring)
      draft%directions(:, members) = 0
    else if (.not. allocated(spring%force)) then
      if (size(spring%constant%temperature) == 1) then
        draft%section_value(members) = spring%constant%value(1, 1)
        return
      end if
    end if
    call assign_law(model, spring, members, draft)
  end subroutine read_spring


  !> Appends a law and assigns it to the elements of a card.
  subroutine assign_law(model, spring, members, draft)
    type(model_type), intent(inout) :: model
    type(spring_type), intent(in) :: spring
    integer, intent(in) :: members(:)            !< drafts
    type(element_draft_type), intent(inout) :: draft
    model%springs = [model%springs, spring]
    draft%spring(members) = size(model%springs)
  end subroutine assign_law


  !> The directions of SPRING1 or SPRING2: 1 to 3.
  subroutine read_directions(reader, row, n, directions, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: n                     !< 1 or 2
    integer, intent(out) :: directions(2)
    logical, intent(out) :: is_ok
    integer :: i
    directions = 0
    is_ok = .true.
    do i = 1, n
      call read_integer(reader, row, i, 'direction', directions(i), is_ok, 1)
      if (.not. is_ok) return
      if (directions(i) >= 1 .and. directions(i) <= 3) cycle
      call report_error(reader, row%line, 'A spring acts in direction 1, 2 or 3; nodes do not turn.')
      directions(i) = 1
    end do
  end subroutine read_directions


  !> Rows of constant, an ignored field, temperature.
  subroutine read_spring_constants(reader, row, spring, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(inout) :: row
    type(spring_type), intent(inout) :: spring
    logical, intent(out) :: is_ok                !< .false.: no members
    real(DP) :: constant, temperature
    logical :: is_good
    real(DP), allocatable :: constants(:)
    allocate (constants(0), spring%constant%temperature(0))
    is_ok = .false.
    do while (next_row(reader%cards, row))
      is_ok = .true.
      is_good = .true.
      call check_n_fields(reader, row, 3)
      call read_real(reader, row, 1, 'spring constant', constant, is_good)
      call read_real(reader, row, 3, 'temperature', temperature, is_good, 0.0_DP)
      if (.not. is_good) cycle
      if (any(spring%constant%temperature >= temperature)) then
        call report_error(reader, row%line, 'The temperatures of the spring constants must ascend.')
        cycle
      end if
      constants = [constants, constant]
      spring%constant%temperature = [spring%constant%temperature, temperature]
    end do
    spring%constant%value = reshape(constants, [1, size(constants)])
    if (is_ok .and. size(constants) == 0) then   ! already reported
      spring%constant%temperature = [0.0_DP]
      spring%constant%value = reshape([1.0_DP], [1, 1])
    end if
  end subroutine read_spring_constants


  !> Rows of force, elongation, temperature; the elongations of one temperature ascend.
  subroutine read_force_curves(reader, row, tables, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(inout) :: row
    type(hardening_curve_type), allocatable, intent(out) :: tables(:)
    logical, intent(out) :: is_ok                !< .false.: no members
    real(DP) :: force, elongation, temperature
    logical :: is_good
    allocate (tables(0))
    do while (next_row(reader%cards, row))
      is_good = .true.
      call check_n_fields(reader, row, 3)
      call read_real(reader, row, 1, 'force', force, is_good, 0.0_DP)
      call read_real(reader, row, 2, 'elongation', elongation, is_good, 0.0_DP)
      call read_real(reader, row, 3, 'temperature', temperature, is_good, 0.0_DP)
      if (is_good) call add_curve_point(reader, row%line, temperature, elongation, force, tables)
    end do
    is_ok = size(tables) > 0
  end subroutine read_force_curves


  !> A point of the table of the last temperature, or the first of the next.
  subroutine add_curve_point(reader, line, temperature, elongation, force, tables)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line
    real(DP), intent(in) :: temperature, elongation, force
    type(hardening_curve_type), allocatable, intent(inout) :: tables(:)
    integer :: n
    n = size(tables)
    if (n > 0) then
      associate (last => tables(n))
        if (temperature < last%temperature) then
          call report_error(reader, line, 'The temperatures of a spring must ascend.')
          return
        else if (.not. temperature > last%temperature) then
          if (elongation <= last%strain(size(last%strain))) call report_error(reader, line, &
            'The elongations of a spring must ascend.')
          last%strain = [last%strain, elongation]
          last%stress = [last%stress, force]
          return
        end if
      end associate
    end if
    tables = [tables, hardening_curve_type(temperature=temperature, strain=[elongation], stress=[force])]
  end subroutine add_curve_point


  !> ORIENTATION: directions 1 to 3 are those of the axes that it names.
  subroutine set_spring_axes(reader, c, parameters, n, directions, spring)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    integer, intent(in) :: n                     !< 1 or 2 directions
    integer, intent(in) :: directions(2)
    type(spring_type), intent(inout) :: spring
    type(coordinate_system_type) :: rule
    real(DP) :: frame(3, 3)
    logical :: is_ok
    integer :: i
    is_ok = .true.
    call find_orientation(reader, c, parameter_text(parameters, 'ORIENTATION'), rule, is_ok)
    if (is_ok .and. rule%is_cylindrical) call report_error(reader, reader%cards%cards(c)%line, &
      'The orientation of springs must be rectangular.')
    spring%axes(1, :) = 1
    if (.not. is_ok .or. rule%is_cylindrical) return
    frame = axes_at(rule, [0.0_DP, 0.0_DP, 0.0_DP])
    do i = 1, n
      spring%axes(:, i) = frame(:, directions(i))
    end do
  end subroutine set_spring_axes


  !> GAP: clearance, direction, an ignored field, stiffness, tension limit.
  subroutine read_gap_element(reader, model, c, members, draft)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: members(:)            !< drafts
    type(element_draft_type), intent(inout) :: draft
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(spring_type) :: gap
    real(DP) :: axis(3)
    integer :: i
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    gap%is_gap = .true.
    is_ok = next_row(reader%cards, row)
    if (.not. is_ok) then
      call report_error(reader, reader%cards%cards(c)%line, 'The data are missing: clearance and direction of the gap.')
      return
    end if
    call check_n_fields(reader, row, 7)
    call read_real(reader, row, 1, 'clearance', gap%clearance, is_ok, 0.0_DP)
    do i = 1, 3
      call read_real(reader, row, i + 1, 'direction', axis(i), is_ok, 0.0_DP)
    end do
    call read_real(reader, row, 6, 'stiffness', gap%stiffness, is_ok, 1.0e12_DP)
    call read_real(reader, row, 7, 'pull', gap%open_force, is_ok, 1.0e-3_DP)
    if (.not. is_ok) return
    if (gap%stiffness <= 0 .or. gap%open_force < 0) call report_error(reader, row%line, &
      'The stiffness of a gap must be positive, and ' // &
      'its pull not negative.')
    if (next_row(reader%cards, row)) call check_no_data(reader, row)
    if (reader%dialect /= DIALECT_CALCULIX) call report_note(reader, reader%cards%cards(c)%line, 'A closed gap is a spring of ' // &
      'stiffness ' // to_text(gap%stiffness) // ' here; the sixth value of the line gives another one.')
    gap%axes(:, 1) = axis
    call assign_law(model, gap, members, draft)
    do i = 1, 3                                  ! along an axis the other displacements of its nodes are not resisted
      if (abs(axis(i)) > 0 .and. .not. any(abs(pack(axis, [1, 2, 3] /= i)) > 0)) draft%directions(:, members) = i
    end do
  end subroutine read_gap_element


  !> Reads all DIST of MPC cards. Nodes, sets, materials and springs must be read; the elements are drafts.
  subroutine read_distance_limits(reader, model, draft)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(element_draft_type), intent(inout) :: draft
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: nodes(:)
    character(:), allocatable :: kind
    type(spring_type), allocatable :: ropes(:)
    integer :: c, line, n, label
    logical :: is_ok, has_row
    label = maxval([0, draft%label(:draft%n)])
    n = count_rows(reader, 'MPC')                ! no more ropes than that
    if (n == 0) return
    allocate (ropes(n))
    call resize_draft(draft, draft%n + n)
    n = 0
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'MPC')) cycle
      call open_card(reader, c, parameters, row)
      has_row = next_row(reader%cards, row)
      do while (has_row)
        call read_next_mpc(reader, model, row, 'DIST', has_row, kind, nodes, line, is_ok)
        if (.not. is_ok .or. kind /= 'DIST') cycle
        nodes = unique_nodes(nodes)
        call read_distance_limit(reader, model, line, nodes, ropes(n + 1), is_ok)
        if (.not. is_ok) cycle
        n = n + 1
        call append_rope(draft, label + n, c, line, nodes(:2), size(model%springs) + n)
      end do
    end do
    call resize_draft(draft, draft%n)
    model%springs = [model%springs, ropes(:n)]
  end subroutine read_distance_limits


  !> A rope between the first two nodes; the first coordinate of the third is its length.
  subroutine read_distance_limit(reader, model, line, nodes, rope, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: line
    integer, intent(in) :: nodes(:)
    type(spring_type), intent(inout) :: rope
    logical, intent(out) :: is_ok
    real(DP) :: distance, modulus
    is_ok = size(nodes) == 3
    if (.not. is_ok) then
      call report_error(reader, line, 'DIST needs a node three times, another one three times, and a node whose first ' // &
        'coordinate is the distance that they may have.')
      return
    end if
    associate (x => model%mesh%coordinates)
      distance = norm2(x(:, nodes(2)) - x(:, nodes(1)))
      rope%clearance = x(1, nodes(3)) - distance
    end associate
    modulus = max_modulus(model)
    is_ok = distance > 0.0_DP .and. modulus > 0.0_DP .and. rope%clearance >= -1.0e-6_DP * distance
    if (.not. is_ok) call report_error(reader, line, 'DIST: the two nodes must be apart at the start, not farther than the ' // &
      'distance given (first coordinate of the last node), and a material must be elastic.')
    rope%is_distance_limit = .true.
    rope%length_node = nodes(3)
    rope%stiffness = LIMIT_STIFFNESS_FACTOR * modulus * distance
  end subroutine read_distance_limit


  !> The largest Young's modulus of all materials, or an estimate of it.
  pure real(DP) function max_modulus(model) result(modulus)
    type(model_type), intent(in) :: model
    integer :: i
    modulus = 0.0_DP
    do i = 1, size(model%materials)
      modulus = max(modulus, model%materials(i)%youngs_modulus)
      if (allocated(model%materials(i)%elastic%value)) modulus = max(modulus, maxval(model%materials(i)%elastic%value(1, :)))
    end do
  end function max_modulus


  !> Appends an element to the drafts, which are long enough.
  subroutine append_rope(draft, label, c, line, nodes, spring)
    type(element_draft_type), intent(inout) :: draft
    integer, intent(in) :: label, c, line, nodes(2)
    integer, intent(in) :: spring                !< index of its law
    draft%n = draft%n + 1
    associate (n => draft%n)
      draft%label(n) = label
      draft%kind(n) = KIND_SPRINGA
      draft%card(n) = c
      draft%line(n) = line
      draft%spring(n) = spring
      call draft%nodes%add(nodes(1))
      call draft%nodes%add(nodes(2))
      draft%first(n + 1) = draft%first(n) + 2
    end associate
  end subroutine append_rope

end module amontons_deck_springs
