!> Unit test of amontons_element_integration_points: input and output of a point, and the split of its tangent.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_element_integration_points
  use amontons_kinds, only: DP
  use amontons_element_integration_points, only: integration_points_type, set_point_input, store_point_output, &
    store_point_history, split_unsymmetric_tangent, ELEMENT_OK, ELEMENT_INVERTED, ELEMENT_NOT_FINITE, ELEMENT_DEGENERATE
  use amontons_material_point, only: material_point_type
  use amontons_materials, only: material_type, MAX_HISTORY
  use amontons_tensor, only: IDENTITY
  use amontons_user_material, only: umat_point_type
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer :: i
  call check_input()
  call check_output()
  call check_history()
  call check_split()
  call suite%that('statuses are distinct', all([ELEMENT_OK, ELEMENT_INVERTED, ELEMENT_NOT_FINITE, ELEMENT_DEGENERATE] &
    == [(i, i=0, 3)]))
  call suite%finish()

contains

  !> Two points with different frames and histories, four nodal temperatures.
  subroutine make_points(points)
    type(integration_points_type), intent(out) :: points
    points%has_frame = .true.
    points%frame(:, :, 1) = IDENTITY
    points%frame(:, :, 2) = reshape([real(DP) :: 0, 1, 0, -1, 0, 0, 0, 0, 1], [3, 3])
    points%history_old(:, 1) = 1
    points%history_old(:, 2) = 2
    points%temperature(:4) = [10.0_DP, 20.0_DP, 30.0_DP, 1.0e9_DP]
    points%initial_temperature(:4) = [1.0_DP, 2.0_DP, 5.0_DP, 1.0e9_DP]
    points%time = 7
    points%time_increment = 0.5_DP
    points%history = -1
    points%stress = -1
  end subroutine make_points


  !> Weighted temperatures, the point's own frame and past; a plain material takes only the global axes.
  subroutine check_input()
    type(integration_points_type) :: points
    type(material_type) :: material
    type(material_point_type) :: point
    call make_points(points)
    material%is_linear_isotropic = .false.
    call set_point_input(material, points, 2, [0.5_DP, 0.25_DP, 0.25_DP], point)
    call suite%near('temperature', point%temperature, 17.5_DP, 1.0e-14_DP)
    call suite%near('initial temperature', point%initial_temperature, 2.25_DP, 1.0e-14_DP)
    call suite%that('its own past', all(point%history_old == 2))
    call suite%that('its own frame', all(point%frame == points%frame(:, :, 2)))
    call suite%that('times', point%time == 7 .and. point%time_increment == 0.5_DP)
    call suite%that('no user data', .not. allocated(point%user))
    points%has_frame = .false.
    call set_point_input(material, points, 2, [1.0_DP], point)
    call suite%that('global axes', all(point%frame == IDENTITY))
    allocate (points%user(1))
    points%user(1)%values%npt = 5
    call set_point_input(material, points, 1, [1.0_DP], point)
    call suite%that('user data', point%user%values%npt == 5)
    material%is_linear_isotropic = .true.
    points%has_frame = .true.
    call set_point_input(material, points, 2, [1.0_DP], point)
    call suite%that('a plain material has the global axes', all(point%frame == IDENTITY))
  end subroutine check_input


  !> Cauchy's stress is Kirchhoff's over J, at finite strain only.
  subroutine check_output()
    type(integration_points_type) :: points
    type(material_type) :: material
    type(material_point_type) :: point
    call make_points(points)
    point%H = 0
    point%H(1, 1) = 0.6_DP
    point%H(2, 2) = 0.25_DP
    point%stress = [2.0_DP, 4.0_DP, 6.0_DP, 8.0_DP, 10.0_DP, 12.0_DP]
    point%strain = 0.5_DP
    point%energy = 3
    point%history = 9
    call store_point_output(material, .true., point, points, 2)
    call suite%near('Cauchy stress', norm2(points%stress(:, 2) - point%stress / 2), 0.0_DP, 1.0e-14_DP)
    call suite%that('strain and energy', all(points%strain(:, 2) == 0.5_DP) .and. points%energy(2) == 3)
    call suite%that('no other point', all(points%stress(:, 1) == -1))
    call suite%that('a plain material has no history', all(points%history == -1))
    material%is_linear_isotropic = .false.
    call store_point_output(material, .false., point, points, 1)
    call suite%that('small strain: the stress as it is', all(points%stress(:, 1) == point%stress))
    call suite%that('history of its point', all(points%history(:, 1) == 9) .and. all(points%history(:, 2) == -1))
  end subroutine check_output


  !> The history of a user's material goes along.
  subroutine check_history()
    type(integration_points_type) :: points
    type(material_point_type) :: point
    call make_points(points)
    allocate (points%user(2))
    point%history = 4
    allocate (point%user)
    point%user%history = [1.0_DP, 2.0_DP, 3.0_DP]
    call store_point_history(point, points, 2)
    call suite%that('rows', all(points%history(:, 2) == 4) .and. size(points%history, 1) == MAX_HISTORY)
    call suite%that('of the user', all(points%user(2)%history == [1.0_DP, 2.0_DP, 3.0_DP]) &
      .and. .not. allocated(points%user(1)%history))
  end subroutine check_history


  !> Symmetric plus skew part is the tangent; rounding is no skew part; only users' laws have one.
  subroutine check_split()
    type(integration_points_type) :: points
    type(material_type) :: material
    type(material_point_type) :: point
    real(DP) :: c(6, 6)
    c = reshape([(real(modulo(7 * i, 11), DP), i=1, 36)], [6, 6])
    point%tangent = c
    call split_unsymmetric_tangent(material, point, points, 1)
    call suite%that('not of a law of the program', all(point%tangent == c) .and. .not. allocated(points%skew))
    material%is_unsymmetric = .true.
    point%tangent = c + transpose(c)
    point%tangent(1, 2) = point%tangent(1, 2) * (1 + 1.0e-14_DP)
    call split_unsymmetric_tangent(material, point, points, 1)
    call suite%that('rounding is no skew part', .not. allocated(points%skew))
    call suite%that('but symmetric to the last bit', all(point%tangent == transpose(point%tangent)))
    point%tangent = c
    call split_unsymmetric_tangent(material, point, points, 2)
    call suite%near('both parts', norm2(point%tangent + points%skew(:, :, 2) - c), 0.0_DP, 1.0e-14_DP)
    call suite%near('skew', norm2(points%skew(:, :, 2) + transpose(points%skew(:, :, 2))), 0.0_DP, 0.0_DP)
    call suite%that('symmetric', all(point%tangent == transpose(point%tangent)) .and. all(points%skew(:, :, 1) == 0))
    point%tangent = c + transpose(c)
    call split_unsymmetric_tangent(material, point, points, 2)
    call suite%that('an old skew part goes', all(points%skew(:, :, 2) == 0))
  end subroutine check_split

end program test_element_integration_points
