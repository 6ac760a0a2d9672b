!> Unit test of amontons_analytic_profiles: lines and arcs: feet, gaps and normals; derivatives of the foot against differences.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_analytic_profiles
  use amontons_analytic_profiles, only: analytic_profile_type, profile_point_type, project_to_profile, evaluate_profile_point, &
    profile_coordinates, profile_length, add_line, add_arc, connect_pieces, PROFILE_PLANAR, PROFILE_EXTRUDED, PROFILE_REVOLVED
  use amontons_kinds, only: DP, PI
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer :: kind
  do kind = PROFILE_PLANAR, PROFILE_REVOLVED
    call check_foot(kind)
  end do
  call check_pieces()
  call check_none()
  call suite%finish()

contains

  !> A line along x from 3 to 1, outward side down, then a quarter of a circle about (1, 1): pieces of length 2 and pi/2.
  subroutine make(kind, profile)
    integer, intent(in) :: kind                    !< PROFILE_...
    type(analytic_profile_type), intent(out) :: profile
    profile%kind = kind
    call add_line(profile, [3.0_DP, 0.0_DP], [1.0_DP, 0.0_DP])
    call add_arc(profile, [1.0_DP, 0.0_DP], [0.0_DP, 1.0_DP], [1.0_DP, 1.0_DP])
    call connect_pieces(profile)
  end subroutine make


  !> Lengths and neighbours.
  subroutine check_pieces()
    type(analytic_profile_type) :: profile
    call make(PROFILE_PLANAR, profile)
    call suite%that('two pieces', profile%n == 2)
    call suite%near('length', profile_length(profile), 2 + 0.5_DP * PI, 1.0e-14_DP)
    call suite%that('chained', all(profile%next == [2, 0]) .and. all(profile%before == [0, 1]))
  end subroutine check_pieces


  !> X = M + g N from the line and from the arc; t . dM = c t . dX and t . dN = q t . dX by differences.
  subroutine check_foot(kind)
    integer, intent(in) :: kind
    type(analytic_profile_type) :: profile
    type(profile_point_type) :: place, moved, again
    real(DP) :: X(3), radius, gap
    real(DP), parameter :: STEP = 1.0e-6_DP
    integer :: piece, a
    logical :: is_found
    call make(kind, profile)
    do piece = 1, 2
      X = [2.0_DP, -0.25_DP, 0.0_DP]
      if (kind == PROFILE_EXTRUDED) X(3) = 7
      gap = 0.25_DP
      if (piece == 2) X(:2) = 1 - 1.25_DP * [0.6_DP, 0.8_DP]
      if (kind == PROFILE_REVOLVED) then           ! radius and height turned about z
        radius = X(1)
        X = [radius * cos(0.4_DP), radius * sin(0.4_DP), X(2)]
      end if
      call project_to_profile(profile, X, 0.1_DP, 1.0_DP, 0, place, is_found)
      call suite%that('found', is_found)
      call suite%that('its piece', place%piece == piece)
      call suite%near('gap', place%gap, gap, 1.0e-14_DP)
      call suite%near('X = M + g N', norm2(place%closest_point + place%gap * place%normal - X), 0.0_DP, 1.0e-14_DP)
      call suite%near('unit normal', norm2(place%normal), 1.0_DP, 1.0e-14_DP)
      do a = 1, 2
        if (kind == PROFILE_PLANAR .and. a == 2) cycle
        call project_to_profile(profile, X + STEP * place%tangent(:, a), 0.1_DP, 1.0_DP, piece, moved, is_found)
        call suite%near('c', dot_product(place%tangent(:, a), moved%closest_point - place%closest_point) / STEP, place%c(a), &
          1.0e-5_DP)
        call suite%near('q', dot_product(place%tangent(:, a), moved%normal - place%normal) / STEP, place%q(a), 1.0e-5_DP)
      end do
      again = evaluate_profile_point(profile, piece, place%xi, gap)
      call suite%near('at its natural coordinates', norm2(again%closest_point - place%closest_point), 0.0_DP, 1.0e-13_DP)
    end do
  end subroutine check_foot


  !> Beyond the end there is nothing; deep behind the surface neither; a walk begins at the wrong piece and ends at the right one.
  subroutine check_none()
    type(analytic_profile_type) :: profile
    type(profile_point_type) :: place
    real(DP) :: X(3), p(2), n(2)
    logical :: is_found
    call make(PROFILE_PLANAR, profile)
    call project_to_profile(profile, [4.0_DP, -0.1_DP, 0.0_DP], 0.1_DP, 1.0_DP, 0, place, is_found)
    call suite%that('beyond the end', .not. is_found)
    call project_to_profile(profile, [3.05_DP, -0.1_DP, 0.0_DP], 0.1_DP, 1.0_DP, 1, place, is_found)
    call suite%that('a little beyond', is_found)
    call project_to_profile(profile, [2.5_DP, 5.0_DP, 0.0_DP], 0.1_DP, 0.5_DP, 0, place, is_found)
    call suite%that('too deep', .not. is_found)
    call project_to_profile(profile, [2.0_DP, -0.2_DP, 0.0_DP], 0.1_DP, 1.0_DP, 2, place, is_found)
    call suite%that('a walk', is_found .and. place%piece == 1)
    call profile_coordinates(profile, 2, [1.0_DP, 0.0_DP], X, p, n)
    call suite%near('the end of the arc', norm2(X - [0.0_DP, 1.0_DP, 0.0_DP]), 0.0_DP, 1.0e-14_DP)
    call suite%near('its normal', norm2(n - [-1.0_DP, 0.0_DP]), 0.0_DP, 1.0e-14_DP)
  end subroutine check_none

end program test_analytic_profiles
