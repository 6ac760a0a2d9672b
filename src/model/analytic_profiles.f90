!> Analytic rigid surfaces: profiles of lines and arcs, extruded or revolved, with closest-point projection.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The chain lies in a plane with coordinates p: x and y of the global axes (PROFILE_PLANAR), x and y of local axes, extruded along
!! the third (PROFILE_EXTRUDED), or radius and height (PROFILE_REVOLVED). The outward side is on the left of the chain's direction.
!!
!! With the outward normal N, the gap g and the principal curvatures k_a (positive for a convex surface), a point X and
!! its closest point M satisfy X = M + g N. A small motion of X gives, along the principal directions t_a,
!!
!!     t_a . dM = c_a t_a . dX,  t_a . dN = q_a t_a . dX,   c_a = 1/(1 + g k_a),  q_a = k_a/(1 + g k_a)
!!
!! of a line, and around the axis of a revolved profile with n_r = N . e_r: c_2 = r_M/r_X, q_2 = n_r/r_X.
module amontons_analytic_profiles
  use amontons_kinds, only: DP
  use amontons_tensor, only: IDENTITY
  implicit none
  private
  public :: analytic_profile_type, profile_point_type, project_to_profile, evaluate_profile_point, profile_coordinates, &
    profile_length, add_line, add_arc, connect_pieces
  public :: PROFILE_PLANAR, PROFILE_EXTRUDED, PROFILE_REVOLVED

  integer, parameter :: PROFILE_PLANAR = 1       !< a line in the plane of plane and axisymmetric elements
  integer, parameter :: PROFILE_EXTRUDED = 2      !< extruded without end
  integer, parameter :: PROFILE_REVOLVED = 3     !< revolved about an axis, full circle

  real(DP), parameter :: TOL_PIECE_END = 1.0e-10_DP   !< tolerance of the end of a piece, relative to its length [-]
  real(DP), parameter :: TOL_JOINED_ENDS = 1.0e-9_DP    !< ends nearer than this times the size of the profile are joined [-]

  !> A profile. Pieces run from start to finish; `signed_radius` is 0 for a line, the radius of an arc whose outward side is away
  !! from its centre, minus the radius of one whose outward side is towards its centre.
  type :: analytic_profile_type
    integer :: kind = PROFILE_PLANAR
    real(DP) :: origin(3) = 0                  !< of the local axes [length]
    real(DP) :: axes(3, 3) = IDENTITY          !< local axes in columns; the third is the axis of a revolved profile
    integer :: n = 0                           !< pieces
    real(DP), allocatable :: start(:, :)       !< (2, n) p [length]
    real(DP), allocatable :: finish(:, :)      !< (2, n) [length]
    real(DP), allocatable :: centre(:, :)      !< (2, n) of arcs [length]
    real(DP), allocatable :: signed_radius(:)           !< (n) [length]
    real(DP), allocatable :: piece_length(:)         !< (n) of the piece [length]
    integer, allocatable :: next(:)            !< (n) the piece that starts at its finish; 0: none
    integer, allocatable :: before(:)          !< (n) the piece that ends at its start; 0: none
    integer :: carriers(4) = 0                 !< nodes that move it: at anchor, and span away along x, y, z (planar: x, y)
    integer :: n_carrier_nodes = 0
    real(DP) :: anchor(3) = 0                  !< [length]
    real(DP) :: span = 1                       !< [length]
  end type analytic_profile_type

  !> The projection of a point on a profile: closest point, gap and their derivatives.
  type :: profile_point_type
    integer :: piece = 0
    real(DP) :: xi(2) = 0                      !< fraction of the piece's length [-]; along the third axis [length] or angle [rad]
    real(DP) :: gap = 0                        !< g [length]
    real(DP) :: closest_point(3) = 0                    !< M [length]
    real(DP) :: normal(3) = 0                  !< N, unit
    real(DP) :: tangent(3, 2) = 0              !< t_a: along the piece, and across
    real(DP) :: c(2) = 1                       !< c_a [-]
    real(DP) :: q(2) = 0                       !< q_a [1/length]
  end type profile_point_type

contains

  !> Appends a line to a point.
  pure subroutine add_line(profile, from, to)
    type(analytic_profile_type), intent(inout) :: profile
    real(DP), intent(in) :: from(2), to(2)     !< p [length]
    call add_piece(profile, from, to, [0.0_DP, 0.0_DP], 0.0_DP)
    profile%piece_length(profile%n) = norm2(to - from)
  end subroutine add_line


  !> Appends an arc of less than half a turn to a point, about a centre. The radius is that of the start.
  pure subroutine add_arc(profile, from, to, centre)
    type(analytic_profile_type), intent(inout) :: profile
    real(DP), intent(in) :: from(2), to(2), centre(2)   !< p [length]
    real(DP) :: radius, turn
    radius = norm2(from - centre)
    turn = cross_product_2d(from - centre, to - centre)
    call add_piece(profile, from, to, centre, sign(radius, -turn))
    profile%piece_length(profile%n) = radius * abs(atan2(turn, dot_product(from - centre, to - centre)))
  end subroutine add_arc


  !> Allocates one more piece.
  pure subroutine add_piece(profile, from, to, centre, bend)
    type(analytic_profile_type), intent(inout) :: profile
    real(DP), intent(in) :: from(2), to(2), centre(2), bend
    integer :: n
    if (profile%n == 0) allocate (profile%start(2, 0), profile%finish(2, 0), profile%centre(2, 0), profile%signed_radius(0), &
      profile%piece_length(0))
    n = profile%n + 1
    profile%n = n
    profile%start = reshape([profile%start, from], [2, n])
    profile%finish = reshape([profile%finish, to], [2, n])
    profile%centre = reshape([profile%centre, centre], [2, n])
    profile%signed_radius = [profile%signed_radius, bend]
    profile%piece_length = [profile%piece_length, 0.0_DP]
  end subroutine add_piece


  !> Connects the pieces: each with the next one, and the last with the first of a closed chain.
  pure subroutine connect_pieces(profile)
    type(analytic_profile_type), intent(inout) :: profile
    integer :: k
    profile%next = [(k + 1, k=1, profile%n)]
    profile%before = [(k - 1, k=1, profile%n)]
    if (profile%n == 0) return
    profile%next(profile%n) = 0
    if (profile%n < 2 .or. .not. are_joined(profile, profile%n, 1)) return
    profile%next(profile%n) = 1
    profile%before(1) = profile%n
  end subroutine connect_pieces


  !> Whether a piece ends where another one starts.
  pure logical function are_joined(profile, k, next)
    type(analytic_profile_type), intent(in) :: profile
    integer, intent(in) :: k, next
    are_joined = norm2(profile%finish(:, k) - profile%start(:, next)) <= TOL_JOINED_ENDS * profile_length(profile)
  end function are_joined


  !> The length of all pieces together [length].
  pure real(DP) function profile_length(profile) result(extent)
    type(analytic_profile_type), intent(in) :: profile
    extent = sum(profile%piece_length)
  end function profile_length


  !> The projection of a point: from the piece of its last projection, or over all pieces.
  !!
  !! From a piece the search continues with the neighbour beyond whose end the projection would lie. At a convex corner and at an
  !! end the piece reaches slightly beyond itself; past that the point has no projection. Without a start piece: the nearest of all
  !! pieces that the point projects on; behind the surface, pieces deeper than `max_penetration` are excluded.
  pure subroutine project_to_profile(profile, X, reach, max_penetration, k, place, is_found)
    type(analytic_profile_type), intent(in) :: profile
    real(DP), intent(in) :: X(3)               !< undeformed coordinates [length]
    real(DP), intent(in) :: reach              !< beyond an end [length]
    real(DP), intent(in) :: max_penetration            !< [length]
    integer, intent(in) :: k                   !< start piece of the search; 0: none
    type(profile_point_type), intent(out) :: place
    logical, intent(out) :: is_found
    real(DP) :: s, gap, p(2)
    integer :: piece
    p = in_plane(profile, X)
    if (k > 0) then
      call search_neighbours(profile, p, reach, k, piece, is_found)
    else
      call search_all_pieces(profile, p, reach, max_penetration, piece, is_found)
    end if
    if (piece == 0) return
    call closest_point_on_piece(profile, piece, p, s, gap)
    place = evaluate_profile_point(profile, piece, [s, out_of_plane_coordinate(profile, X)], gap)
  end subroutine project_to_profile


  !> The nearest of all pieces that a point projects on; 0: none.
  pure subroutine search_all_pieces(profile, p, reach, max_penetration, piece, is_found)
    type(analytic_profile_type), intent(in) :: profile
    real(DP), intent(in) :: p(2), reach, max_penetration   !< [length]
    integer, intent(out) :: piece
    logical, intent(out) :: is_found
    real(DP) :: s, gap, beyond, way, shortest
    integer :: k
    shortest = huge(1.0_DP)
    piece = 0
    do k = 1, profile%n
      call closest_point_on_piece(profile, k, p, s, gap)
      beyond = distance_beyond_end(profile, k, s)
      if (beyond > reach .or. gap < -max_penetration) cycle
      way = hypot(gap, beyond)
      if (way >= shortest) cycle
      shortest = way
      piece = k
    end do
    is_found = piece > 0
  end subroutine search_all_pieces


  !> Searches along the chain from a piece to the one that a point projects on.
  pure subroutine search_neighbours(profile, p, reach, from, piece, is_found)
    type(analytic_profile_type), intent(in) :: profile
    real(DP), intent(in) :: p(2), reach        !< [length]
    integer, intent(in) :: from
    integer, intent(out) :: piece              !< the last piece examined
    logical, intent(out) :: is_found
    real(DP) :: s, gap, beyond, last_beyond
    integer :: step, last, next
    piece = from
    last = 0
    last_beyond = huge(1.0_DP)
    is_found = .false.
    do step = 1, 2 * profile%n + 2
      call closest_point_on_piece(profile, piece, p, s, gap)
      beyond = distance_beyond_end(profile, piece, s)
      is_found = beyond <= 0.0_DP
      if (is_found) return
      next = merge(profile%before(piece), profile%next(piece), s < 0.0_DP)
      if (next == 0 .or. next == last) then      ! an end, or a convex corner: beyond both sides
        if (next == last .and. next > 0 .and. last_beyond <= beyond) piece = last
        is_found = min(beyond, merge(last_beyond, beyond, next > 0)) <= reach
        return
      end if
      last = piece
      last_beyond = beyond
      piece = next
    end do
  end subroutine search_neighbours


  !> Distance of a projection beyond the ends of its piece; 0 on it, within the tolerance [length].
  pure real(DP) function distance_beyond_end(profile, k, s) result(beyond)
    type(analytic_profile_type), intent(in) :: profile
    integer, intent(in) :: k
    real(DP), intent(in) :: s                  !< fraction of the piece's length [-]
    beyond = max(-s, s - 1.0_DP)
    if (beyond <= TOL_PIECE_END) beyond = 0.0_DP
    beyond = beyond * profile%piece_length(k)
  end function distance_beyond_end


  !> The projection of a point on a piece, or on the line or circle that extends it.
  pure subroutine closest_point_on_piece(profile, k, p, s, gap)
    type(analytic_profile_type), intent(in) :: profile
    integer, intent(in) :: k                   !< piece
    real(DP), intent(in) :: p(2)               !< [length]
    real(DP), intent(out) :: s                 !< fraction of the piece's length [-]
    real(DP), intent(out) :: gap               !< [length]
    real(DP) :: t(2), a(2), v(2), middle(2), way
    associate (start => profile%start(:, k), bend => profile%signed_radius(k))
      if (abs(bend) <= 0.0_DP) then
        t = (profile%finish(:, k) - start) / profile%piece_length(k)
        s = dot_product(p - start, t) / profile%piece_length(k)
        gap = dot_product(p - start, [-t(2), t(1)])
        return
      end if
      v = p - profile%centre(:, k)
      a = start - profile%centre(:, k)
      gap = sign(1.0_DP, bend) * (norm2(v) - abs(bend))
      way = -sign(1.0_DP, bend) * profile%piece_length(k) / abs(bend)      ! angle of the arc, counterclockwise
      middle = rotated_2d(a, 0.5_DP * way)
      s = 0.5_DP + atan2(cross_product_2d(middle, v), dot_product(middle, v)) / way
    end associate
  end subroutine closest_point_on_piece


  !> Closest point, normal, tangents and derivatives at natural coordinates of a piece, for a point at a gap along the normal.
  pure function evaluate_profile_point(profile, k, xi, gap) result(place)
    type(analytic_profile_type), intent(in) :: profile
    integer, intent(in) :: k                   !< piece
    real(DP), intent(in) :: xi(2)              !< natural coordinates [-]
    real(DP), intent(in) :: gap                !< [length]
    type(profile_point_type) :: place
    real(DP) :: p(2), n(2), out(3), around(3), radius
    call profile_coordinates(profile, k, xi, place%closest_point, p, n)
    place%piece = k
    place%xi = xi
    place%gap = gap
    if (abs(profile%signed_radius(k)) > 0.0_DP) then
      place%c(1) = profile%signed_radius(k) / (profile%signed_radius(k) + gap)
      place%q(1) = 1.0_DP / (profile%signed_radius(k) + gap)
    end if
    if (profile%kind == PROFILE_REVOLVED) then
      out = cos(xi(2)) * profile%axes(:, 1) + sin(xi(2)) * profile%axes(:, 2)
      around = cos(xi(2)) * profile%axes(:, 2) - sin(xi(2)) * profile%axes(:, 1)
      place%normal = n(1) * out + n(2) * profile%axes(:, 3)
      place%tangent = reshape([n(2) * out - n(1) * profile%axes(:, 3), around], [3, 2])
      radius = p(1) + gap * n(1)
      place%c(2) = place%c(1)                  ! on the axis all directions are equivalent
      place%q(2) = place%q(1)
      if (radius <= TOL_PIECE_END * profile_length(profile)) return
      place%c(2) = p(1) / radius
      place%q(2) = n(1) / radius
    else
      place%normal = n(1) * profile%axes(:, 1) + n(2) * profile%axes(:, 2)
      place%tangent(:, 1) = n(2) * profile%axes(:, 1) - n(1) * profile%axes(:, 2)
      place%tangent(:, 2) = profile%axes(:, 3)
    end if
  end function evaluate_profile_point


  !> A point of the surface; in the plane of the profile the outward normal as well.
  pure subroutine profile_coordinates(profile, k, xi, X, p, n)
    type(analytic_profile_type), intent(in) :: profile
    integer, intent(in) :: k                   !< piece
    real(DP), intent(in) :: xi(2)              !< natural coordinates [-]
    real(DP), intent(out) :: X(3)              !< [length]
    real(DP), intent(out) :: p(2)              !< [length]
    real(DP), intent(out) :: n(2)              !< unit
    real(DP) :: t(2), local(3)
    associate (start => profile%start(:, k), bend => profile%signed_radius(k))
      if (abs(bend) > 0.0_DP) then
        t = rotated_2d(start - profile%centre(:, k), -sign(1.0_DP, bend) * xi(1) * profile%piece_length(k) / abs(bend)) / abs(bend)
        p = profile%centre(:, k) + abs(bend) * t
        n = sign(1.0_DP, bend) * t
      else
        t = (profile%finish(:, k) - start) / profile%piece_length(k)
        p = start + xi(1) * profile%piece_length(k) * t
        n = [-t(2), t(1)]
      end if
    end associate
    select case (profile%kind)
    case (PROFILE_REVOLVED)
      local = [p(1) * cos(xi(2)), p(1) * sin(xi(2)), p(2)]
    case (PROFILE_EXTRUDED)
      local = [p, xi(2)]
    case default
      local = [p, 0.0_DP]
    end select
    X = profile%origin + matmul(profile%axes, local)
  end subroutine profile_coordinates


  !> The coordinates p of a point in the plane of the profile.
  pure function in_plane(profile, X) result(p)
    type(analytic_profile_type), intent(in) :: profile
    real(DP), intent(in) :: X(3)               !< [length]
    real(DP) :: p(2), local(3)
    local = matmul(X - profile%origin, profile%axes)
    p = local(:2)
    if (profile%kind == PROFILE_REVOLVED) p = [norm2(local(:2)), local(3)]
  end function in_plane


  !> The coordinate of a point across the plane of the profile: along the third axis [length], or the angle about it [rad].
  pure real(DP) function out_of_plane_coordinate(profile, X) result(t)
    type(analytic_profile_type), intent(in) :: profile
    real(DP), intent(in) :: X(3)               !< [length]
    real(DP) :: local(3)
    local = matmul(X - profile%origin, profile%axes)
    t = 0.0_DP
    if (profile%kind == PROFILE_EXTRUDED) t = local(3)
    if (profile%kind == PROFILE_REVOLVED .and. any(abs(local(:2)) > 0.0_DP)) t = atan2(local(2), local(1))
  end function out_of_plane_coordinate


  !> a x b in the plane.
  pure real(DP) function cross_product_2d(a, b)
    real(DP), intent(in) :: a(2), b(2)
    cross_product_2d = a(1) * b(2) - a(2) * b(1)
  end function cross_product_2d


  !> A vector rotated counterclockwise by an angle.
  pure function rotated_2d(v, angle) result(w)
    real(DP), intent(in) :: v(2), angle
    real(DP) :: w(2)
    w = [cos(angle) * v(1) - sin(angle) * v(2), sin(angle) * v(1) + cos(angle) * v(2)]
  end function rotated_2d

end module amontons_analytic_profiles
