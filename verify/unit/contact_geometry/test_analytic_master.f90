!> Tests of analytic masters: projections on profiles against closed forms, and all derivatives against differences.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_analytic_master
  use amontons_kinds, only: DP
  use amontons_facets, only: facets_type
  use amontons_surface_projection, only: gap_derivatives_type, projection_type, track_projection, find_projection, &
    evaluate_gap_derivatives, &
    PROJECTION_INSIDE, PROJECTION_OUTSIDE
  use amontons_facet_search, only: facet_search_type
  use amontons_analytic_profiles, only: analytic_profile_type, add_line, add_arc, connect_pieces, PROFILE_PLANAR, &
    PROFILE_EXTRUDED, PROFILE_REVOLVED
  use amontons_contact_constraint_rows, only: contact_row_type, fill_facet_row, evaluate_relative_position
  use amontons_analytic_master, only: build_profile_facets
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer :: kind
  call check_sphere(suite)
  call check_cylinder(suite)
  call check_walk(suite)
  call check_deep(suite)
  do kind = PROFILE_PLANAR, PROFILE_REVOLVED
    call check_derivatives(suite, kind, .true.)
    call check_derivatives(suite, kind, .false.)
  end do
  call check_pole(suite)
  call suite%finish()

contains

  !> Facets of a profile whose carriers are the nodes 2 to 5 (flat: 2 to 4); node 1 is the slave.
  subroutine move_profile(profile, facets, x)
    type(analytic_profile_type), intent(inout) :: profile
    type(facets_type), intent(out) :: facets
    real(DP), intent(out) :: x(3, 5)
    integer :: k
    call connect_pieces(profile)
    profile%n_carrier_nodes = merge(3, 4, profile%kind == PROFILE_PLANAR)
    profile%carriers = [2, 3, 4, 5]
    profile%anchor = [0.3_DP, -0.2_DP, 0.0_DP]
    profile%span = 1.7_DP
    x = 0.0_DP
    do k = 1, profile%n_carrier_nodes
      x(:, k + 1) = profile%anchor + merge(profile%span, 0.0_DP, [1, 2, 3] == k - 1)
    end do
    call build_profile_facets(profile, 0.1_DP, facets)
  end subroutine move_profile


  !> A rotation by an angle about an axis through the origin, then a translation.
  pure function moved(x, angle, shift) result(y)
    real(DP), intent(in) :: x(:, :), angle, shift(3)
    real(DP) :: y(3, size(x, 2)), R(3, 3)
    R = reshape([cos(angle), sin(angle), 0.0_DP, -sin(angle), cos(angle), 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3])
    y = matmul(R, x) + spread(shift, 2, size(x, 2))
  end function moved


  !> Half a ball of radius 2 about (0, 0, 0), rotated about the x axis, its pole at x = -2.
  subroutine make_ball(profile)
    type(analytic_profile_type), intent(out) :: profile
    profile%kind = PROFILE_REVOLVED
    profile%axes = reshape(real([0, 1, 0, 0, 0, 1, 1, 0, 0], DP), [3, 3])
    call add_arc(profile, [2.0_DP, 0.0_DP], [0.0_DP, -2.0_DP], [0.0_DP, 0.0_DP])
  end subroutine make_ball


  !> Gap and normal of a moved ball follow from its centre and radius; the row gives the same relative position.
  subroutine check_sphere(suite)
    type(suite_type), intent(inout) :: suite
    type(analytic_profile_type) :: profile
    type(facets_type) :: facets
    type(facet_search_type) :: search
    type(projection_type) :: found
    type(contact_row_type) :: row
    real(DP) :: x(3, 5), y(3, 5), centre(3), point(3), way(3)
    integer :: i
    real(DP), parameter :: POINTS(3, 3) = reshape([-2.3_DP, 0.4_DP, 0.7_DP, -1.5_DP, -0.8_DP, 0.9_DP, -3.0_DP, 0.0_DP, 0.0_DP], &
      [3, 3])
    call make_ball(profile)
    call move_profile(profile, facets, x)
    y = moved(x, 0.7_DP, [1.0_DP, 2.0_DP, -3.0_DP])
    centre = [1.0_DP, 2.0_DP, -3.0_DP]
    do i = 1, 3
      y(:, :1) = moved(POINTS(:, i:i), 0.7_DP, [1.0_DP, 2.0_DP, -3.0_DP])
      point = y(:, 1)
      call find_projection(facets, search, y, point, 5.0_DP, found)
      way = point - centre
      call suite%that('ball: on', found%status == PROJECTION_INSIDE)
      call suite%near('ball: gap', found%gap, norm2(way) - 2, 1.0e-14_DP)
      call suite%near('ball: normal', norm2(found%normal - way / norm2(way)), 0.0_DP, 1.0e-14_DP)
      call fill_facet_row(facets, found%facet, found%xi, 1, row)
      call suite%near('ball: the row', norm2(evaluate_relative_position(row, y) - found%gap * found%normal), 0.0_DP, 1.0e-14_DP)
    end do
  end subroutine check_sphere


  !> A bore: the outward side of an arc that runs counterclockwise is towards its axis.
  subroutine check_cylinder(suite)
    type(suite_type), intent(inout) :: suite
    type(analytic_profile_type) :: profile
    type(facets_type) :: facets
    type(facet_search_type) :: search
    type(projection_type) :: found
    real(DP) :: x(3, 5)
    profile%kind = PROFILE_EXTRUDED
    call add_arc(profile, [1.5_DP, 0.0_DP], [0.0_DP, 1.5_DP], [0.0_DP, 0.0_DP])
    call move_profile(profile, facets, x)
    x(:, 1) = [0.6_DP, 0.8_DP, 40.0_DP]
    call find_projection(facets, search, x, x(:, 1), 5.0_DP, found)
    call suite%near('bore: gap', found%gap, 0.5_DP, 1.0e-14_DP)
    call suite%near('bore: normal', norm2(found%normal + [0.6_DP, 0.8_DP, 0.0_DP]), 0.0_DP, 1.0e-14_DP)
  end subroutine check_cylinder


  !> From a plateau over a rounded shoulder down a wall, and over a corner that is not rounded.
  subroutine check_walk(suite)
    type(suite_type), intent(inout) :: suite
    type(analytic_profile_type) :: profile
    type(facets_type) :: facets
    real(DP) :: x(3, 5), xi(2), g, n(3)
    integer :: f, status
    call add_line(profile, [4.0_DP, 0.0_DP], [1.0_DP, 0.0_DP])    ! outward is down: a punch from its right side
    call add_arc(profile, [1.0_DP, 0.0_DP], [0.0_DP, 1.0_DP], [1.0_DP, 1.0_DP])
    call add_line(profile, [0.0_DP, 1.0_DP], [0.0_DP, 3.0_DP])
    call add_line(profile, [0.0_DP, 3.0_DP], [1.0_DP, 3.0_DP])
    call move_profile(profile, facets, x)
    f = 1
    call track_projection(facets, x, [-0.1_DP, 2.0_DP, 0.0_DP], f, xi, g, n, status)
    call suite%that('walk: to the wall', f == 3 .and. status == PROJECTION_INSIDE)
    call suite%near('walk: gap at the wall', g, 0.1_DP, 1.0e-14_DP)
    call suite%near('walk: place on the wall', xi(1), 0.5_DP, 1.0e-14_DP)
    f = 3
    call track_projection(facets, x, [0.25_DP, 0.25_DP, 0.0_DP], f, xi, g, n, status)
    call suite%near('walk: gap at the shoulder', g, sqrt(1.125_DP) - 1, 1.0e-14_DP)
    call suite%that('walk: to the shoulder', f == 2)
    call track_projection(facets, x, [-0.005_DP, 3.004_DP, 0.0_DP], f, xi, g, n, status)
    call suite%that('walk: a little beyond a corner', status == PROJECTION_INSIDE)
    call track_projection(facets, x, [-0.1_DP, 3.1_DP, 0.0_DP], f, xi, g, n, status)
    call suite%that('walk: beyond a corner', status == PROJECTION_OUTSIDE)
    call track_projection(facets, x, [4.05_DP, -0.1_DP, 0.0_DP], f, xi, g, n, status)
    call suite%that('walk: beyond an end', status == PROJECTION_OUTSIDE)
  end subroutine check_walk


  !> A point deeper than allowed has no projection, one far in front has.
  subroutine check_deep(suite)
    type(suite_type), intent(inout) :: suite
    type(analytic_profile_type) :: profile
    type(facets_type) :: facets
    type(facet_search_type) :: search
    type(projection_type) :: found
    real(DP) :: x(3, 5)
    call add_line(profile, [-1.0_DP, 0.0_DP], [1.0_DP, 0.0_DP])
    call move_profile(profile, facets, x)
    call find_projection(facets, search, x, [0.2_DP, -0.4_DP, 0.0_DP], 0.3_DP, found)
    call suite%that('deep: none', found%facet == 0 .and. found%status == PROJECTION_OUTSIDE)
    call find_projection(facets, search, x, [0.2_DP, 9.0_DP, 0.0_DP], 0.3_DP, found)
    call suite%near('deep: far in front', found%gap, 9.0_DP, 1.0e-14_DP)
  end subroutine check_deep


  !> Gap, normal and weights at a point of the surface, as a list.
  function values_at(facets, x, f) result(values)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)
    integer, intent(in) :: f
    real(DP) :: values(8), xi(2), g, n(3)
    type(contact_row_type) :: row
    integer :: facet, status
    facet = f
    call track_projection(facets, x, x(:, 1), facet, xi, g, n, status)
    if (facet /= f) error stop 'a point of the derivative test left its piece'
    call fill_facet_row(facets, facet, xi, 1, row)
    values = 0.0_DP
    values(:4) = [g, n]
    values(5:3 + size(row%nodes)) = row%weights(2:)
  end function values_at


  !> Gap, normal and weights against central differences, of the slave and of every carrier, also where these are sheared.
  subroutine check_derivatives(suite, kind, is_rigid)
    type(suite_type), intent(inout) :: suite
    integer, intent(in) :: kind
    logical, intent(in) :: is_rigid
    type(analytic_profile_type) :: profile
    type(facets_type) :: facets
    type(facet_search_type) :: search
    type(projection_type) :: found
    real(DP) :: x(3, 5), worst
    integer :: i
    real(DP), parameter :: POINTS(3, 4) = reshape([0.9_DP, 0.1_DP, 0.3_DP, 0.5_DP, -1.1_DP, -0.2_DP, 1.4_DP, 0.3_DP, 1.2_DP, &
      0.7_DP, -0.3_DP, -0.6_DP], [3, 4])
    profile%kind = kind
    call add_arc(profile, [1.0_DP, -0.6_DP], [1.6_DP, 0.0_DP], [1.6_DP, -0.6_DP])
    call add_line(profile, [1.6_DP, 0.0_DP], [2.4_DP, 0.5_DP])
    call add_arc(profile, [0.2_DP, -1.4_DP], [0.8_DP, -0.8_DP], [0.2_DP, -0.8_DP])
    call move_profile(profile, facets, x)
    worst = 0.0_DP
    do i = 1, 4
      x(:, 1) = merge(POINTS(:, i), 0.0_DP, [.true., .true., kind /= PROFILE_PLANAR])
      if (.not. is_rigid) x(:2, 4) = x(:2, 4) + [0.2_DP, 0.1_DP]
      x = moved(x, 0.4_DP * real(i, DP), [0.1_DP, 0.2_DP, 0.0_DP])
      call find_projection(facets, search, x, x(:, 1), 5.0_DP, found)
      if (found%facet == 0) error stop 'a point of the derivative test has no place'
      call compare(facets, x, found, worst)
      call move_profile(profile, facets, x)
    end do
    call suite%near('derivatives against central differences', worst, 0.0_DP, 1.0e-8_DP)
  end subroutine check_derivatives


  !> One point: the largest difference.
  subroutine compare(facets, x, found, worst)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)
    type(projection_type), intent(in) :: found
    real(DP), intent(inout) :: worst
    type(gap_derivatives_type) :: exact
    real(DP) :: y(3, 5), difference(8), expected(8)
    real(DP), parameter :: H = 1.0e-5_DP
    integer :: j, k, n
    call evaluate_gap_derivatives(facets, x, found%facet, found%xi, found%gap, exact)
    n = exact%n_nodes
    worst = max(worst, norm2(exact%n - found%normal))
    do j = 0, n
      do k = 1, merge(2, 3, n == 3)
        y = x
        y(k, j + 1) = x(k, j + 1) + H
        difference = values_at(facets, y, found%facet)
        y(k, j + 1) = x(k, j + 1) - H
        difference = (difference - values_at(facets, y, found%facet)) / (2 * H)
        expected = 0.0_DP
        if (j == 0) then
          expected(:4) = [exact%d_gap_slave(k), exact%d_n_slave(:, k)]
          expected(5:4 + n) = -matmul(exact%d_xi_slave(:, k), exact%d_weights)
        else
          expected(:4) = [exact%d_gap(k, j), exact%d_n(:, k, j)]
          expected(5:4 + n) = -matmul(exact%d_xi(:, k, j), exact%d_weights)
        end if
        worst = max(worst, maxval(abs(difference - expected)))
      end do
    end do
  end subroutine compare


  !> At the pole of a ball, where the angle about the axis is undefined, the derivatives are those of a ball as well.
  subroutine check_pole(suite)
    type(suite_type), intent(inout) :: suite
    type(analytic_profile_type) :: profile
    type(facets_type) :: facets
    type(facet_search_type) :: search
    type(projection_type) :: found
    real(DP) :: x(3, 5), worst
    call make_ball(profile)
    call move_profile(profile, facets, x)
    x(:, 1) = [-2.2_DP, 0.0_DP, 0.0_DP]
    call find_projection(facets, search, x, x(:, 1), 5.0_DP, found)
    worst = 0.0_DP
    call compare(facets, x, found, worst)
    call suite%near('pole: derivatives against central differences', worst, 0.0_DP, 1.0e-8_DP)
    call suite%near('pole: normal', found%normal(1), -1.0_DP, 1.0e-14_DP)
  end subroutine check_pole

end program test_analytic_master
