!> Profiles: analytic surfaces: a chain of lines and arcs, drawn out or turned about an axis; the closest point of them, exactly.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The chain lies in a plane with coordinates p: x and y of the global axes (PROFILE_FLAT), x and y of local axes, drawn out along
!! the third (PROFILE_DRAWN), or radius and height (PROFILE_TURNED). Its outward side is on the left as one walks along it.
!!
!! With the outward normal N, the gap g and the principal curvatures k_a (positive where the surface bulges out) a point and
!! its foot M are bound by X = M + g N. So for a small motion of X, along the principal directions t_a,
!!
!!     t_a . dM = c_a t_a . dX,  t_a . dN = q_a t_a . dX,   c_a = 1/(1 + g k_a),  q_a = k_a/(1 + g k_a)
!!
!! of a line and around the axis of a turned profile with n_r = N . e_r: c_2 = r_M/r_X, q_2 = n_r/r_X.
module amontons_analytic_profiles
  use amontons_kinds, only: DP
  use amontons_tensor, only: IDENTITY
  implicit none
  private
  public :: profile_type, place_type, find_place, place_at, point_of, extent_of, add_line, add_arc, finish_profile
  public :: PROFILE_FLAT, PROFILE_DRAWN, PROFILE_TURNED

  integer, parameter :: PROFILE_FLAT = 1       !< a line in the plane of plane and axisymmetric elements
  integer, parameter :: PROFILE_DRAWN = 2      !< drawn out without end
  integer, parameter :: PROFILE_TURNED = 3     !< turned about an axis, once round

  real(DP), parameter :: ON_END = 1.0e-10_DP   !< beyond the end of a piece by less than this times its length is on it [-]
  real(DP), parameter :: JOINED = 1.0e-9_DP    !< ends nearer than this times the size of the profile are one [-]

  !> A profile. Pieces go from start to finish; `bend` is 0 for a line, the radius of an arc whose outward side is away from
  !! its centre, minus the radius of one whose outward side is towards its centre.
  type :: profile_type
    integer :: kind = PROFILE_FLAT
    real(DP) :: origin(3) = 0                  !< of the local axes [length]
    real(DP) :: axes(3, 3) = IDENTITY          !< local axes in columns; the third is the axis of a turned profile
    integer :: n = 0                           !< pieces
    real(DP), allocatable :: start(:, :)       !< (2, n) p [length]
    real(DP), allocatable :: finish(:, :)      !< (2, n) [length]
    real(DP), allocatable :: centre(:, :)      !< (2, n) of arcs [length]
    real(DP), allocatable :: bend(:)           !< (n) [length]
    real(DP), allocatable :: extent(:)         !< (n) of the piece [length]
    integer, allocatable :: next(:)            !< (n) the piece that goes on at its finish; 0: none
    integer, allocatable :: before(:)          !< (n) the piece that ends at its start; 0: none
    integer :: carriers(4) = 0                 !< nodes that carry it: at anchor, and span away along x, y, z (flat: x, y)
    integer :: n_carriers = 0
    real(DP) :: anchor(3) = 0                  !< [length]
    real(DP) :: span = 1                       !< [length]
  end type profile_type

  !> A point of a profile, and what is at a distance of it along the normal.
  type :: place_type
    integer :: piece = 0
    real(DP) :: xi(2) = 0                      !< part of the piece's length [-]; along the third axis [length] or angle [rad]
    real(DP) :: gap = 0                        !< g [length]
    real(DP) :: foot(3) = 0                    !< M [length]
    real(DP) :: normal(3) = 0                  !< N, unit
    real(DP) :: tangent(3, 2) = 0              !< t_a: along the piece, and across
    real(DP) :: c(2) = 1                       !< c_a [-]
    real(DP) :: q(2) = 0                       !< q_a [1/length]
  end type place_type

contains

  !> One more piece: a line to a point.
  pure subroutine add_line(profile, from, to)
    type(profile_type), intent(inout) :: profile
    real(DP), intent(in) :: from(2), to(2)     !< p [length]
    call add_piece(profile, from, to, [0.0_DP, 0.0_DP], 0.0_DP)
    profile%extent(profile%n) = norm2(to - from)
  end subroutine add_line


  !> One more piece: an arc of less than half a turn to a point, about a centre. The radius is that of the start.
  pure subroutine add_arc(profile, from, to, centre)
    type(profile_type), intent(inout) :: profile
    real(DP), intent(in) :: from(2), to(2), centre(2)   !< p [length]
    real(DP) :: radius, turn
    radius = norm2(from - centre)
    turn = cross(from - centre, to - centre)
    call add_piece(profile, from, to, centre, sign(radius, -turn))
    profile%extent(profile%n) = radius * abs(atan2(turn, dot_product(from - centre, to - centre)))
  end subroutine add_arc


  !> Room for one more piece.
  pure subroutine add_piece(profile, from, to, centre, bend)
    type(profile_type), intent(inout) :: profile
    real(DP), intent(in) :: from(2), to(2), centre(2), bend
    integer :: n
    if (profile%n == 0) allocate (profile%start(2, 0), profile%finish(2, 0), profile%centre(2, 0), profile%bend(0), &
      profile%extent(0))
    n = profile%n + 1
    profile%n = n
    profile%start = reshape([profile%start, from], [2, n])
    profile%finish = reshape([profile%finish, to], [2, n])
    profile%centre = reshape([profile%centre, centre], [2, n])
    profile%bend = [profile%bend, bend]
    profile%extent = [profile%extent, 0.0_DP]
  end subroutine add_piece


  !> Which pieces hang together: each with the next one, and the last with the first where the chain is closed.
  pure subroutine finish_profile(profile)
    type(profile_type), intent(inout) :: profile
    integer :: k
    profile%next = [(k + 1, k=1, profile%n)]
    profile%before = [(k - 1, k=1, profile%n)]
    if (profile%n == 0) return
    profile%next(profile%n) = 0
    if (profile%n < 2 .or. .not. are_joined(profile, profile%n, 1)) return
    profile%next(profile%n) = 1
    profile%before(1) = profile%n
  end subroutine finish_profile


  !> Whether a piece ends where another one starts.
  pure logical function are_joined(profile, k, next)
    type(profile_type), intent(in) :: profile
    integer, intent(in) :: k, next
    are_joined = norm2(profile%finish(:, k) - profile%start(:, next)) <= JOINED * extent_of(profile)
  end function are_joined


  !> The length of all pieces together [length].
  pure real(DP) function extent_of(profile) result(extent)
    type(profile_type), intent(in) :: profile
    extent = sum(profile%extent)
  end function extent_of


  !> The place of a point: from the piece where it was last, or from any.
  !!
  !! From a piece it walks to the neighbour beyond whose end the foot would be. At a corner that sticks out and at an end the
  !! piece reaches a little beyond itself; past that the point has no place. From nowhere: of all pieces that hold the point
  !! the nearest one; behind the surface none that is deeper than `deepest`.
  pure subroutine find_place(profile, X, reach, deepest, k, place, is_on)
    type(profile_type), intent(in) :: profile
    real(DP), intent(in) :: X(3)               !< undeformed coordinates [length]
    real(DP), intent(in) :: reach              !< beyond an end [length]
    real(DP), intent(in) :: deepest            !< [length]
    integer, intent(in) :: k                   !< piece where the walk begins; 0: none
    type(place_type), intent(out) :: place
    logical, intent(out) :: is_on
    real(DP) :: s, gap, p(2)
    integer :: piece
    p = in_plane(profile, X)
    if (k > 0) then
      call walk(profile, p, reach, k, piece, is_on)
    else
      call look_around(profile, p, reach, deepest, piece, is_on)
    end if
    if (piece == 0) return
    call foot_on(profile, piece, p, s, gap)
    place = place_at(profile, piece, [s, across(profile, X)], gap)
  end subroutine find_place


  !> Of all pieces that hold a point the nearest one; 0: none does.
  pure subroutine look_around(profile, p, reach, deepest, piece, is_on)
    type(profile_type), intent(in) :: profile
    real(DP), intent(in) :: p(2), reach, deepest   !< [length]
    integer, intent(out) :: piece
    logical, intent(out) :: is_on
    real(DP) :: s, gap, beyond, way, shortest
    integer :: k
    shortest = huge(1.0_DP)
    piece = 0
    do k = 1, profile%n
      call foot_on(profile, k, p, s, gap)
      beyond = excess(profile, k, s)
      if (beyond > reach .or. gap < -deepest) cycle
      way = hypot(gap, beyond)
      if (way >= shortest) cycle
      shortest = way
      piece = k
    end do
    is_on = piece > 0
  end subroutine look_around


  !> From a piece to the one that holds a point.
  pure subroutine walk(profile, p, reach, from, piece, is_on)
    type(profile_type), intent(in) :: profile
    real(DP), intent(in) :: p(2), reach        !< [length]
    integer, intent(in) :: from
    integer, intent(out) :: piece              !< the last one looked at
    logical, intent(out) :: is_on
    real(DP) :: s, gap, beyond, last_beyond
    integer :: step, last, next
    piece = from
    last = 0
    last_beyond = huge(1.0_DP)
    is_on = .false.
    do step = 1, 2 * profile%n + 2
      call foot_on(profile, piece, p, s, gap)
      beyond = excess(profile, piece, s)
      is_on = beyond <= 0.0_DP
      if (is_on) return
      next = merge(profile%before(piece), profile%next(piece), s < 0.0_DP)
      if (next == 0 .or. next == last) then      ! an end, or a corner: beyond both sides
        if (next == last .and. next > 0 .and. last_beyond <= beyond) piece = last
        is_on = min(beyond, merge(last_beyond, beyond, next > 0)) <= reach
        return
      end if
      last = piece
      last_beyond = beyond
      piece = next
    end do
  end subroutine walk


  !> How far a foot is beyond the ends of its piece; 0 on it, and a hair outside [length].
  pure real(DP) function excess(profile, k, s) result(beyond)
    type(profile_type), intent(in) :: profile
    integer, intent(in) :: k
    real(DP), intent(in) :: s                  !< part of the piece's length [-]
    beyond = max(-s, s - 1.0_DP)
    if (beyond <= ON_END) beyond = 0.0_DP
    beyond = beyond * profile%extent(k)
  end function excess


  !> The foot of a point on a piece, or on the line or circle that goes on beyond it.
  pure subroutine foot_on(profile, k, p, s, gap)
    type(profile_type), intent(in) :: profile
    integer, intent(in) :: k                   !< piece
    real(DP), intent(in) :: p(2)               !< [length]
    real(DP), intent(out) :: s                 !< part of the piece's length [-]
    real(DP), intent(out) :: gap               !< [length]
    real(DP) :: t(2), a(2), v(2), middle(2), way
    associate (start => profile%start(:, k), bend => profile%bend(k))
      if (abs(bend) <= 0.0_DP) then
        t = (profile%finish(:, k) - start) / profile%extent(k)
        s = dot_product(p - start, t) / profile%extent(k)
        gap = dot_product(p - start, [-t(2), t(1)])
        return
      end if
      v = p - profile%centre(:, k)
      a = start - profile%centre(:, k)
      gap = sign(1.0_DP, bend) * (norm2(v) - abs(bend))
      way = -sign(1.0_DP, bend) * profile%extent(k) / abs(bend)      ! angle of the arc, counterclockwise
      middle = turned(a, 0.5_DP * way)
      s = 0.5_DP + atan2(cross(middle, v), dot_product(middle, v)) / way
    end associate
  end subroutine foot_on


  !> What is at natural coordinates of a piece, for a point at a distance along the normal there.
  pure function place_at(profile, k, xi, gap) result(place)
    type(profile_type), intent(in) :: profile
    integer, intent(in) :: k                   !< piece
    real(DP), intent(in) :: xi(2)              !< natural coordinates [-]
    real(DP), intent(in) :: gap                !< [length]
    type(place_type) :: place
    real(DP) :: p(2), n(2), out(3), around(3), radius
    call point_of(profile, k, xi, place%foot, p, n)
    place%piece = k
    place%xi = xi
    place%gap = gap
    if (abs(profile%bend(k)) > 0.0_DP) then
      place%c(1) = profile%bend(k) / (profile%bend(k) + gap)
      place%q(1) = 1.0_DP / (profile%bend(k) + gap)
    end if
    if (profile%kind == PROFILE_TURNED) then
      out = cos(xi(2)) * profile%axes(:, 1) + sin(xi(2)) * profile%axes(:, 2)
      around = cos(xi(2)) * profile%axes(:, 2) - sin(xi(2)) * profile%axes(:, 1)
      place%normal = n(1) * out + n(2) * profile%axes(:, 3)
      place%tangent = reshape([n(2) * out - n(1) * profile%axes(:, 3), around], [3, 2])
      radius = p(1) + gap * n(1)
      place%c(2) = place%c(1)                  ! on the axis all directions are alike
      place%q(2) = place%q(1)
      if (radius <= ON_END * extent_of(profile)) return
      place%c(2) = p(1) / radius
      place%q(2) = n(1) / radius
    else
      place%normal = n(1) * profile%axes(:, 1) + n(2) * profile%axes(:, 2)
      place%tangent(:, 1) = n(2) * profile%axes(:, 1) - n(1) * profile%axes(:, 2)
      place%tangent(:, 2) = profile%axes(:, 3)
    end if
  end function place_at


  !> A point of the surface; in the plane of the profile also the outward normal there.
  pure subroutine point_of(profile, k, xi, X, p, n)
    type(profile_type), intent(in) :: profile
    integer, intent(in) :: k                   !< piece
    real(DP), intent(in) :: xi(2)              !< natural coordinates [-]
    real(DP), intent(out) :: X(3)              !< [length]
    real(DP), intent(out) :: p(2)              !< [length]
    real(DP), intent(out) :: n(2)              !< unit
    real(DP) :: t(2), local(3)
    associate (start => profile%start(:, k), bend => profile%bend(k))
      if (abs(bend) > 0.0_DP) then
        t = turned(start - profile%centre(:, k), -sign(1.0_DP, bend) * xi(1) * profile%extent(k) / abs(bend)) / abs(bend)
        p = profile%centre(:, k) + abs(bend) * t
        n = sign(1.0_DP, bend) * t
      else
        t = (profile%finish(:, k) - start) / profile%extent(k)
        p = start + xi(1) * profile%extent(k) * t
        n = [-t(2), t(1)]
      end if
    end associate
    select case (profile%kind)
    case (PROFILE_TURNED)
      local = [p(1) * cos(xi(2)), p(1) * sin(xi(2)), p(2)]
    case (PROFILE_DRAWN)
      local = [p, xi(2)]
    case default
      local = [p, 0.0_DP]
    end select
    X = profile%origin + matmul(profile%axes, local)
  end subroutine point_of


  !> A point in the plane of the profile: p.
  pure function in_plane(profile, X) result(p)
    type(profile_type), intent(in) :: profile
    real(DP), intent(in) :: X(3)               !< [length]
    real(DP) :: p(2), local(3)
    local = matmul(X - profile%origin, profile%axes)
    p = local(:2)
    if (profile%kind == PROFILE_TURNED) p = [norm2(local(:2)), local(3)]
  end function in_plane


  !> A point across the plane of the profile: along the third axis [length], or the angle about it [rad].
  pure real(DP) function across(profile, X) result(t)
    type(profile_type), intent(in) :: profile
    real(DP), intent(in) :: X(3)               !< [length]
    real(DP) :: local(3)
    local = matmul(X - profile%origin, profile%axes)
    t = 0.0_DP
    if (profile%kind == PROFILE_DRAWN) t = local(3)
    if (profile%kind == PROFILE_TURNED .and. any(abs(local(:2)) > 0.0_DP)) t = atan2(local(2), local(1))
  end function across


  !> a x b in the plane.
  pure real(DP) function cross(a, b)
    real(DP), intent(in) :: a(2), b(2)
    cross = a(1) * b(2) - a(2) * b(1)
  end function cross


  !> A vector turned counterclockwise by an angle.
  pure function turned(v, angle) result(w)
    real(DP), intent(in) :: v(2), angle
    real(DP) :: w(2)
    w = [cos(angle) * v(1) - sin(angle) * v(2), sin(angle) * v(1) + cos(angle) * v(2)]
  end function turned

end module amontons_analytic_profiles
