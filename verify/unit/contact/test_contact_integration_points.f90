!> Unit test of contact_integration_points: points of faces, their rows and areas, what they inherit, removed pairs.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_contact_integration_points
  use amontons_contact_integration_points, only: update_points, nearest_point
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_errors, only: error_type
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_state, only: state_type, slave_state_type, STATUS_SLIP
  use amontons_steps, only: step_type
  use amontons_surfaces, only: BEHAVIOR_LINEAR
  use amontons_element_kinds, only: KIND_C3D8
  use check, only: suite_type
  implicit none
  real(DP), parameter :: TOL = 1.0e-12_DP
  type(suite_type) :: suite
  type(model_type) :: model
  type(equilibrium_type), allocatable :: system
  type(state_type) :: state
  call check_nearest()
  call start()
  call check_points()
  call check_inheritance()
  call check_removed()
  call suite%finish()

contains

  include 'sample_blocks.inc'

  !> The first of the nearest places; none of none.
  subroutine check_nearest()
    real(DP), parameter :: PLACES(2, 4) = reshape([-0.5_DP, -0.5_DP, 0.5_DP, -0.5_DP, 0.5_DP, 0.5_DP, -0.5_DP, 0.5_DP], [2, 4])
    call suite%that('nearest', nearest_point(PLACES, [0.4_DP, 0.3_DP]) == 3)
    call suite%that('the first of equal ones', nearest_point(PLACES, [0.0_DP, 0.0_DP]) == 1)
    call suite%that('rounding does not decide', nearest_point(PLACES, [1.0e-12_DP, 0.0_DP]) == 1)
    call suite%that('no places', nearest_point(PLACES(:, :0), [0.0_DP, 0.0_DP]) == 0)
  end subroutine check_nearest


  !> Blocks whose contact is springs at points of the slave faces.
  subroutine start()
    call two_blocks(model, 0.3_DP, 0.0_DP, [0.0_DP, 0.0_DP, -0.1_DP])
    model%interactions(1)%behavior = BEHAVIOR_LINEAR
    model%interactions(1)%stiffness = 1000
    model%interactions(1)%stick_slope = 100
    model%pairs(1)%is_mortar = .true.
    model%pairs(1)%has_point_contact = .true.
    call start_blocks(model, system, state)
    state%old%slaves = state%new%slaves
    call update_points(system%contact, model, state)
  end subroutine start


  !> Points cover the faces; a row interpolates both surfaces: its weights add up to zero and give the gap.
  subroutine check_points()
    real(DP) :: d(3)
    logical :: is_right
    integer :: i, k
    associate (points => state%new%slaves, mortar => system%contact%mortar(1))
      call suite%that('points on nine faces', size(points) >= 36 .and. all([(any(points%slave_facet == i), i=1, 9)]))
      call suite%near('areas add up to the surface', sum(points%area), 1.6_DP**2, TOL)
      call suite%that('both states', size(state%old%slaves) == size(points))
      is_right = .true.
      do i = 1, size(points)
        associate (row => mortar%rows(points(i)%row))
          d = 0
          do k = 1, size(row%nodes)
            d = d + row%weights(k) * model%mesh%coordinates(:, row%nodes(k))
          end do
          is_right = is_right .and. abs(sum(row%weights)) < TOL .and. maxval(abs(d)) < TOL .and. size(row%nodes) == 8
          is_right = is_right .and. any(row%nodes == points(i)%node) .and. points(i)%node > 18 .and. points(i)%node < 35
        end associate
      end do
      call suite%that('rows', is_right)
      call suite%near('normals out of the master', maxval([(maxval(abs(mortar%places(i)%normal - [0.0_DP, 0.0_DP, 1.0_DP])), i=1, &
        size(points))]), 0.0_DP, TOL)
    end associate
  end subroutine check_points


  !> After both bodies moved together the points are the same, with the states they had; sideways each inherits from its face.
  subroutine check_inheritance()
    integer, allocatable :: facets(:)
    integer :: i
    state%old%slaves%status = STATUS_SLIP
    state%old%slaves%is_initialized = .true.
    state%old%slaves%energy = [(real(state%old%slaves(i)%slave_facet, DP), i=1, size(state%old%slaves))]
    facets = state%old%slaves%slave_facet
    state%old%u = 0.5_DP
    call update_points(system%contact, model, state)
    call suite%that('the same points', size(state%new%slaves) == size(facets) .and. all(state%new%slaves%slave_facet == facets))
    call suite%that('their states', all(state%new%slaves%status == STATUS_SLIP) .and. all(state%new%slaves%is_initialized))
    state%old%u(1, 19:) = 0.75_DP
    call update_points(system%contact, model, state)
    call suite%near('of the same face', maxval(abs(state%new%slaves%energy - real(state%new%slaves%slave_facet, DP))), 0.0_DP, &
      0.0_DP)
    state%old%slaves = pack(state%old%slaves, state%old%slaves%slave_facet /= 5)
    call update_points(system%contact, model, state)
    call suite%that('a face without points before: new, but not at the start of the job', &
      all(pack(state%new%slaves%is_initialized, &
      state%new%slaves%slave_facet == 5)) .and. all(abs(pack(state%new%slaves%energy, state%new%slaves%slave_facet == 5)) <= 0))
  end subroutine check_inheritance


  !> A removed pair has no points; a pair of nodes keeps its slaves.
  subroutine check_removed()
    type(slave_state_type) :: node
    node%pair = 1
    node%node = 19
    system%contact%is_removed = .true.
    call update_points(system%contact, model, state)
    call suite%that('no points', size(state%new%slaves) == 0)
    model%pairs(1)%has_point_contact = .false.
    state%new%slaves = [node]
    call update_points(system%contact, model, state)
    call suite%that('left alone', size(state%new%slaves) == 1)
  end subroutine check_removed

end program test_contact_integration_points
