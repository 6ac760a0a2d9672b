!> Analytic surfaces (SEGMENTS, CYLINDER, REVOLUTION) and their rigid-body carrier nodes.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_analytic_surfaces
  use amontons_kinds, only: DP
  use amontons_text, only: upper_case, to_text, parse_real, NUMBER_OK
  use amontons_tensor, only: cross_product
  use amontons_analytic_profiles, only: analytic_profile_type, add_line, add_arc, connect_pieces, profile_length, PROFILE_PLANAR, &
    PROFILE_EXTRUDED, &
    PROFILE_REVOLVED
  use amontons_mesh, only: append_node
  use amontons_surfaces, only: surface_type
  use amontons_mpc_data, only: nonlinear_mpc_type
  use amontons_model, only: model_type, append_mpc, gather_constraints
  use amontons_cards, only: parameter_type, data_row_type, next_row, field_text
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word
  use amontons_deck_reader, only: reader_type, open_card, report_error, read_real, check_n_fields
  implicit none
  private
  public :: read_profile, attach_profile, is_analytic_type

  real(DP), parameter :: TOL_PERPENDICULAR = 1.0e-4_DP      !< largest cosine between axes that are meant to be perpendicular [-]
  real(DP), parameter :: TOL_ARC_RADIUS = 1.0e-3_DP     !< both ends of an arc are equally far from its centre to this part of the
                                                        !! radius [-]

contains

  !> Whether a TYPE of SURFACE is that of an analytic surface.
  pure logical function is_analytic_type(word)
    character(*), intent(in) :: word             !< squeezed
    is_analytic_type = word == 'SEGMENTS' .or. word == 'CYLINDER' .or. word == 'REVOLUTION'
  end function is_analytic_type


  !> The profile of one card: its local axes, then START and the pieces.
  subroutine read_profile(reader, c, surface)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(surface_type), intent(inout) :: surface
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    type(analytic_profile_type) :: profile
    real(DP) :: axes(9), fillet
    integer :: n_axes, status
    logical :: is_ok, has_row
    call open_card(reader, c, parameters, row)
    is_ok = .true.
    surface%element = [integer ::]
    surface%face = [integer ::]
    surface%nodes = [integer ::]
    axes = [0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, -1.0_DP]
    n_axes = 0
    select case (parameter_word(parameters, 'TYPE', ''))
    case ('CYLINDER')
      profile%kind = PROFILE_EXTRUDED
      n_axes = 9
    case ('REVOLUTION')
      profile%kind = PROFILE_REVOLVED
      axes(4:6) = [0.0_DP, 1.0_DP, 0.0_DP]
      n_axes = 6
    end select
    has_row = next_row(reader%cards, row)
    call read_axes(reader, row, n_axes, axes, has_row, is_ok)
    if (is_ok) call set_axes(reader, c, axes, profile, is_ok)
    call read_pieces(reader, c, row, has_row, profile, is_ok)
    fillet = 0.0_DP
    if (has_parameter(parameters, 'FILLET RADIUS')) then
      call parse_real(parameter_text(parameters, 'FILLET RADIUS'), fillet, status)
      if (status /= NUMBER_OK .or. fillet <= 0.0_DP) call report_error(reader, reader%cards%cards(c)%line, &
        'FILLET RADIUS must be a positive number.')
      if (is_ok .and. fillet > 0.0_DP) call apply_fillets(reader, c, fillet, profile)
    end if
    call connect_pieces(profile)
    surface%profile = profile
  end subroutine read_profile


  !> The lines before START: points a and b, then for CYLINDER point c. They may be absent or blank.
  subroutine read_axes(reader, row, n_axes, axes, has_row, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(inout) :: row
    integer, intent(in) :: n_axes                !< numbers expected: 0, 6 or 9
    real(DP), intent(inout) :: axes(9)           !< a, b, c [length]
    logical, intent(inout) :: has_row
    logical, intent(inout) :: is_ok
    integer :: i, start
    do start = 0, n_axes - 1, 6
      if (.not. has_row) return
      if (upper_case(field_text(reader%cards, row, 1)) == 'START') return
      if (row%n > 0 .and. field_text(reader%cards, row, 1) // field_text(reader%cards, row, 2) // &
        field_text(reader%cards, row, 3) /= '') then
        call check_n_fields(reader, row, min(6, n_axes - start))
        do i = 1, min(6, n_axes - start)
          call read_real(reader, row, i, 'coordinate', axes(start + i), is_ok, 0.0_DP)
        end do
      end if
      has_row = next_row(reader%cards, row)
    end do
  end subroutine read_axes


  !> Local axes. CYLINDER: x from a to b, the generator from a to c against z. REVOLUTION: z from a to b.
  subroutine set_axes(reader, c, axes, profile, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    real(DP), intent(in) :: axes(9)              !< a, b, c [length]
    type(analytic_profile_type), intent(inout) :: profile
    logical, intent(inout) :: is_ok
    real(DP) :: along(3), third(3)
    if (profile%kind == PROFILE_PLANAR) return
    profile%origin = axes(:3)
    along = axes(4:6) - axes(:3)
    third = axes(:3) - axes(7:9)
    is_ok = norm2(along) > 0.0_DP .and. (norm2(third) > 0.0_DP .or. profile%kind == PROFILE_REVOLVED)
    if (.not. is_ok) then
      call report_error(reader, reader%cards%cards(c)%line, 'The points of the local axes must differ from the origin.')
      return
    end if
    along = along / norm2(along)
    if (profile%kind == PROFILE_REVOLVED) then
      third = along
      along = 0.0_DP
      along(minloc(abs(third), dim=1)) = 1.0_DP
      along = along - dot_product(along, third) * third
      along = along / norm2(along)
    else
      third = third / norm2(third)
      is_ok = abs(dot_product(along, third)) <= TOL_PERPENDICULAR
      if (.not. is_ok) call report_error(reader, reader%cards%cards(c)%line, 'The generator (a to c) must be perpendicular ' // &
        'to the local x axis (a to b).')
      third = third - dot_product(along, third) * along
      third = third / norm2(third)
    end if
    profile%axes = reshape([along, cross_product(third, along), third], [3, 3])
  end subroutine set_axes


  !> START, LINE, CIRCL.
  subroutine read_pieces(reader, c, row, has_row, profile, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    type(data_row_type), intent(inout) :: row         !< at the row of START
    logical, intent(inout) :: has_row
    type(analytic_profile_type), intent(inout) :: profile
    logical, intent(inout) :: is_ok
    character(:), allocatable :: word
    real(DP) :: from(2), x(4)
    integer :: i, n
    logical :: has_start
    has_start = .false.
    do while (has_row)
      word = upper_case(field_text(reader%cards, row, 1))
      n = merge(4, 2, word == 'CIRCL')
      if (word /= 'START' .and. word /= 'LINE' .and. word /= 'CIRCL') then
        call report_error(reader, row%line, 'A line of an analytic surface begins with START, LINE or CIRCL, not with ''' // word &
          // &
          '''; put CIRCL for PARAB.')
        is_ok = .false.
      else if ((word == 'START') .eqv. has_start) then
        call report_error(reader, row%line, 'An analytic surface is one chain: START once, then LINE and CIRCL.')
        is_ok = .false.
      else
        call check_n_fields(reader, row, n + 1)
        do i = 1, n
          call read_real(reader, row, i + 1, 'coordinate', x(i), is_ok)
        end do
        if (is_ok .and. word /= 'START') call add_piece(reader, row, word, from, x, profile, is_ok)
        from = x(:2)
      end if
      has_start = has_start .or. word == 'START'
      has_row = next_row(reader%cards, row)
    end do
    if (is_ok .and. profile%n == 0) call report_error(reader, reader%cards%cards(c)%line, &
      'The surface has no pieces: START, then LINE or CIRCL.')
    if (profile%n == 0) is_ok = .false.
  end subroutine read_pieces


  !> Reads one piece, if the row defines one.
  subroutine add_piece(reader, row, word, from, x, profile, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    character(*), intent(in) :: word
    real(DP), intent(in) :: from(2)              !< [length]
    real(DP), intent(in) :: x(4)                 !< end, centre [length]
    type(analytic_profile_type), intent(inout) :: profile
    logical, intent(inout) :: is_ok
    real(DP) :: a(2), b(2), radius
    a = from - x(3:4)
    b = x(:2) - x(3:4)
    radius = norm2(a)
    if (profile%kind == PROFILE_REVOLVED .and. min(from(1), x(1)) < 0.0_DP) then
      call report_error(reader, row%line, 'The radius of a surface of revolution must not be negative.')
    else if (norm2(x(:2) - from) <= 0.0_DP) then
      call report_error(reader, row%line, 'The piece has no length.')
    else if (word == 'LINE') then
      call add_line(profile, from, x(:2))
      return
    else if (abs(norm2(b) - radius) > TOL_ARC_RADIUS * radius .or. .not. radius > 0.0_DP) then
      call report_error(reader, row%line, 'The ends of the arc are ' // to_text(radius) // ' and ' // to_text(norm2(b)) // &
        ' from its centre; they must be equally far.')
    else if (abs(a(1) * b(2) - a(2) * b(1)) <= 1.0e-9_DP * radius**2) then
      call report_error(reader, row%line, 'An arc must be less than half a circle; make two of it.')
    else
      call add_arc(profile, from, x(:2), x(3:4))
      return
    end if
    is_ok = .false.
  end subroutine add_piece


  !> FILLET RADIUS: corners between lines become tangent arcs.
  subroutine apply_fillets(reader, c, radius, profile)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    real(DP), intent(in) :: radius               !< [length]
    type(analytic_profile_type), intent(inout) :: profile
    type(analytic_profile_type) :: rounded
    real(DP) :: from(2), corner(2), t(2), s(2), cut, side
    integer :: k
    rounded%kind = profile%kind
    rounded%origin = profile%origin
    rounded%axes = profile%axes
    from = profile%start(:, 1)
    do k = 1, profile%n
      corner = profile%finish(:, k)
      side = 0.0_DP
      cut = 0.0_DP
      if (k < profile%n) then
        t = end_direction(profile, k)
        s = start_direction(profile, k + 1)
        side = t(1) * s(2) - t(2) * s(1)
      end if
      if (abs(side) > 1.0e-6_DP) then
        cut = radius * abs(side) / (1.0_DP + dot_product(t, s))
        if (any(abs(profile%signed_radius(k:k + 1)) > 0.0_DP) .or. cut > 0.5_DP * minval(profile%piece_length(k:k + 1))) then
          call report_error(reader, reader%cards%cards(c)%line, &
            'FILLET RADIUS rounds corners between lines that are longer than ' // &
            'twice what it cuts off; give the arc at piece ' // to_text(k) // ' by CIRCL.')
          return
        end if
      end if
      if (abs(profile%signed_radius(k)) > 0.0_DP) then
        call add_arc(rounded, from, corner, profile%centre(:, k))
      else
        call add_line(rounded, from, corner - cut * (corner - from) / norm2(corner - from))
      end if
      from = corner
      if (cut > 0.0_DP) then
        from = corner + cut * s
        call add_arc(rounded, corner - cut * t, from, corner - cut * t + sign(radius, side) * [-t(2), t(1)])
      end if
    end do
    profile = rounded
  end subroutine apply_fillets


  !> The direction in which a piece ends.
  pure function end_direction(profile, k) result(t)
    type(analytic_profile_type), intent(in) :: profile
    integer, intent(in) :: k
    real(DP) :: t(2), n(2)
    n = (profile%finish(:, k) - profile%centre(:, k)) / max(abs(profile%signed_radius(k)), tiny(1.0_DP))
    t = sign(1.0_DP, profile%signed_radius(k)) * [n(2), -n(1)]
    if (abs(profile%signed_radius(k)) <= 0.0_DP) t = (profile%finish(:, k) - profile%start(:, k)) / profile%piece_length(k)
  end function end_direction


  !> The direction in which a piece starts.
  pure function start_direction(profile, k) result(t)
    type(analytic_profile_type), intent(in) :: profile
    integer, intent(in) :: k
    real(DP) :: t(2), n(2)
    n = (profile%start(:, k) - profile%centre(:, k)) / max(abs(profile%signed_radius(k)), tiny(1.0_DP))
    t = sign(1.0_DP, profile%signed_radius(k)) * [n(2), -n(1)]
    if (abs(profile%signed_radius(k)) <= 0.0_DP) t = (profile%finish(:, k) - profile%start(:, k)) / profile%piece_length(k)
  end function start_direction


  !> RIGID BODY, ANALYTICAL SURFACE: creates the carrier nodes at and near the reference node, and constrains them to it.
  subroutine attach_profile(model, surface, body)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: surface               !< index of the surface
    type(nonlinear_mpc_type), intent(in) :: body          !< with reference node and rotation node
    type(nonlinear_mpc_type) :: mpc
    real(DP) :: x(3)
    integer :: k
    if (.not. allocated(model%surfaces(surface)%profile%piece_length)) return   ! its error is reported
    associate (profile => model%surfaces(surface)%profile)
      profile%n_carrier_nodes = merge(3, 4, profile%kind == PROFILE_PLANAR)
      profile%anchor = model%mesh%coordinates(:, body%reference)
      profile%span = max(profile_length(profile), tiny(1.0_DP))
      call gather_constraints(model)               ! no rotation node is pending where nodes are created
      do k = 1, profile%n_carrier_nodes
        x = profile%anchor
        x = x + merge(profile%span, 0.0_DP, [1, 2, 3] == k - 1)
        call append_node(model%mesh, x, profile%carriers(k))
        model%rotation_of = [model%rotation_of, 0]
        model%mesh%is_unstiffened(3, profile%carriers(k)) = profile%kind == PROFILE_PLANAR
      end do
      model%surfaces(surface)%nodes = profile%carriers(:profile%n_carrier_nodes)
      mpc = body
      mpc%node = profile%carriers(:profile%n_carrier_nodes)
      mpc%is_bound(3) = profile%kind /= PROFILE_PLANAR
      call append_mpc(model, mpc)
    end associate
  end subroutine attach_profile

end module amontons_deck_analytic_surfaces
