!> Tests of the facet search: no facet within the margin is missed, the order ascends, and the grid stays small.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_facet_search
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: FACET_TRI3, FACET_QUAD4, FACET_TRI6, FACET_QUAD8, KIND_C3D6, KIND_C3D8, KIND_C3D10, &
    KIND_C3D20
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_facets, only: facets_type, build_facets
  use amontons_facet_search, only: facet_search_type, build_facet_search, renew_facet_search, find_near_facets
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer :: kind
  do kind = FACET_TRI3, FACET_QUAD8
    call check_against_all(suite, kind, 0.3_DP)
  end do
  call check_against_all(suite, FACET_QUAD4, 0.0_DP)
  call check_against_all(suite, FACET_QUAD4, 5.0_DP)
  call check_one_facet(suite)
  call check_place_and_size(suite)
  call check_size_of_grid(suite)
  call check_graded(suite)
  call check_empty(suite)
  call check_moving(suite)
  call suite%finish()

contains

  include 'sample_surfaces.inc'

  subroutine make_grid(kind, nx, ny, wave, mesh, facets)
    integer, intent(in) :: kind, nx, ny
    real(DP), intent(in) :: wave
    type(mesh_type), intent(out) :: mesh
    type(facets_type), intent(out) :: facets
    type(error_type), allocatable :: error
    integer, allocatable :: element(:), face(:)
    call flat_grid(kind, nx, ny, mesh, element, face)
    call shake(mesh, wave, 0.1_DP * wave)
    call fold(mesh, 7.0_DP, wave)
    call build_facets(mesh, element, face, facets, error)
    if (allocated(error)) error stop 'the sample surface is bad'
  end subroutine make_grid


  !> A surface that moves: the grid follows once it has moved farther than the slack.
  subroutine check_moving(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(facet_search_type) :: search
    integer, allocatable :: list(:)
    real(DP), allocatable :: x(:, :)
    real(DP) :: point(3)
    integer :: n
    call make_grid(FACET_QUAD4, 4, 3, 0.0_DP, mesh, facets)
    call build_facet_search(facets, mesh%coordinates, 0.5_DP, search)
    x = mesh%coordinates
    x(1, :) = x(1, :) + 40.0_DP
    point = sum(x(:, facets%nodes(facets%first(1):facets%first(2) - 1)), dim=2) / 4
    call find_near_facets(search, point, list, n)
    call suite%that('the old grid does not reach there', n == 0)
    call renew_facet_search(facets, x, 41.0_DP, search)
    call find_near_facets(search, point, list, n)
    call suite%that('within the slack the grid stays', n == 0)
    call renew_facet_search(facets, x, 0.1_DP, search)
    call find_near_facets(search, point, list, n)
    call suite%that('beyond it the grid follows', any(list(:n) == 1))
    call suite%that('its margin stays', abs(search%margin - 0.5_DP) <= 0.0_DP)
  end subroutine check_moving


  !> Distance from a point to the nearest corner of a facet: never less than the distance to the facet.
  pure function corner_distance(mesh, facets, f, point) result(distance)
    type(mesh_type), intent(in) :: mesh
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f
    real(DP), intent(in) :: point(3)
    real(DP) :: distance
    integer :: k
    distance = huge(1.0_DP)
    do k = facets%first(f), facets%first(f + 1) - 1
      distance = min(distance, norm2(mesh%coordinates(:, facets%nodes(k)) - point))
    end do
  end function corner_distance


  !> Against a loop over all facets: those with a node within the margin are in the list, and no facet of the list is far.
  subroutine check_against_all(suite, kind, margin)
    type(suite_type), intent(inout) :: suite
    integer, intent(in) :: kind
    real(DP), intent(in) :: margin
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(facet_search_type) :: search
    integer, allocatable :: list(:)
    integer :: i, f, n, n_missed, n_far, n_unordered, n_found
    real(DP) :: point(3), distance
    call make_grid(kind, 9, 7, 0.5_DP, mesh, facets)
    call build_facet_search(facets, mesh%coordinates, margin, search)
    n_missed = 0
    n_far = 0
    n_unordered = 0
    n_found = 0
    do i = 1, 300
      point = [11.0_DP, 9.0_DP, 2.0_DP] * modulo([0.819173_DP, 0.671044_DP, 0.549700_DP] * real(i, DP), 1.0_DP) - 1.0_DP
      call find_near_facets(search, point, list, n)
      n_found = n_found + n
      if (any(list(2:n) <= list(:n - 1))) n_unordered = n_unordered + 1
      do f = 1, facets%n
        distance = corner_distance(mesh, facets, f, point)
        if (distance <= margin .and. .not. any(list(:n) == f)) n_missed = n_missed + 1
        if (distance > 2 * margin + 4 .and. any(list(:n) == f)) n_far = n_far + 1
      end do
    end do
    call suite%that('some are found', n_found > 100)
    call suite%that('none within the margin is missed', n_missed == 0)
    call suite%that('none is far', n_far == 0)
    call suite%that('the order ascends', n_unordered == 0)
  end subroutine check_against_all


  subroutine check_one_facet(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(facet_search_type) :: search
    integer, allocatable :: list(:)
    integer :: n
    call make_grid(FACET_QUAD4, 1, 1, 0.0_DP, mesh, facets)
    call build_facet_search(facets, mesh%coordinates, 0.0_DP, search)
    call find_near_facets(search, [0.5_DP, 0.5_DP, 0.0_DP], list, n)
    call suite%that('one facet: on it', n == 1 .and. list(1) == 1)
    call find_near_facets(search, [1.1_DP, -0.1_DP, 0.0_DP], list, n)
    call suite%that('one facet: in its extension zone', n == 1)
    call find_near_facets(search, [0.5_DP, 0.5_DP, 0.2_DP], list, n)
    call suite%that('one facet: above', n == 0)
    call build_facet_search(facets, mesh%coordinates, 1.0_DP, search)
    call find_near_facets(search, [0.5_DP, 0.5_DP, 1.0_DP], list, n)
    call suite%that('one facet: at the margin', n == 1)
    if (allocated(list)) deallocate (list)
    call find_near_facets(search, [-50.0_DP, 0.5_DP, 0.0_DP], list, n)
    call suite%that('one facet: far on one side', n == 0)
    call suite%that('a list that nothing was found for has bounds', allocated(list))
    call find_near_facets(search, [50.0_DP, 0.5_DP, 0.0_DP], list, n)
    call suite%that('one facet: far on the other', n == 0)
  end subroutine check_one_facet


  !> The same surface far from the origin and in other units finds the same facets.
  subroutine check_place_and_size(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh, moved
    type(facets_type) :: facets
    type(facet_search_type) :: here, there
    integer, allocatable :: a(:), b(:)
    integer :: i, k, n, m, n_wrong
    real(DP) :: point(3)
    real(DP), parameter :: UNITS(3) = [1.0e-6_DP, 1.0_DP, 1.0e5_DP], SHIFT(3) = [3.0e3_DP, -7.0e3_DP, 11.0_DP]
    call make_grid(FACET_TRI3, 12, 5, 0.5_DP, mesh, facets)
    call build_facet_search(facets, mesh%coordinates, 0.25_DP, here)
    n_wrong = 0
    do k = 1, 3
      moved = mesh
      do i = 1, mesh%n_nodes
        moved%coordinates(:, i) = UNITS(k) * (mesh%coordinates(:, i) + SHIFT)
      end do
      call build_facet_search(facets, moved%coordinates, UNITS(k) * 0.25_DP, there)
      do i = 1, 100
        point = [12.0_DP, 5.0_DP, 0.5_DP] * modulo([0.819173_DP, 0.671044_DP, 0.549700_DP] * real(i, DP), 1.0_DP)
        call find_near_facets(here, point, a, n)
        call find_near_facets(there, UNITS(k) * (point + SHIFT), b, m)
        if (n /= m) n_wrong = n_wrong + 1
        if (n == m) n_wrong = n_wrong + count(a(:n) /= b(:n))
      end do
    end do
    call suite%that('place and units do not matter', n_wrong == 0)
  end subroutine check_place_and_size


  !> There is a bounded number of buckets and entries per facet, also for a thin surface across space.
  subroutine check_size_of_grid(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(facet_search_type) :: search
    integer :: i
    call make_grid(FACET_QUAD4, 60, 50, 0.3_DP, mesh, facets)
    call build_facet_search(facets, mesh%coordinates, 0.3_DP, search)
    call suite%that('buckets per facet', size(search%first) <= 8 * facets%n + 65)
    call suite%that('entries per facet', size(search%facet) <= 30 * facets%n)
    call make_grid(FACET_QUAD4, 2000, 1, 0.0_DP, mesh, facets)
    do i = 1, mesh%n_nodes - 1                       ! along the diagonal of space
      mesh%coordinates(:, i) = mesh%coordinates(1, i) + [0.0_DP, mesh%coordinates(2, i), 0.0_DP]
    end do
    call build_facet_search(facets, mesh%coordinates, 0.1_DP, search)
    call suite%that('buckets of a diagonal strip', size(search%first) <= 8 * facets%n + 65)
    call suite%that('entries of a diagonal strip', size(search%facet) <= 30 * facets%n)
  end subroutine check_size_of_grid


  !> Facets whose sizes differ by a factor of millions: a query reads few of them, and those whose box contains the point are found.
  subroutine check_graded(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(facet_search_type) :: search
    integer, allocatable :: list(:)
    real(DP) :: point(3)
    integer :: i, f, n, n_wrong
    call make_grid(FACET_QUAD4, 60, 50, 0.0_DP, mesh, facets)
    mesh%coordinates(:2, :) = (mesh%coordinates(:2, :) / 50.0_DP)**5
    call build_facet_search(facets, mesh%coordinates, 0.0_DP, search)
    call suite%that('graded: entries per facet', size(search%facet) <= 30 * facets%n)
    call suite%that('graded: facets in a bucket', maxval(search%first(2:) - search%first(:size(search%first) - 1)) <= 100)
    n_wrong = 0
    do i = 1, facets%n, 7
      point = sum(mesh%coordinates(:, facets%nodes(facets%first(i):facets%first(i + 1) - 1)), dim=2) / 4.0_DP
      call find_near_facets(search, point, list, n)
      n_wrong = n_wrong + abs(n - count([(all(point >= search%box(:, 1, f) .and. point <= search%box(:, 2, f)), f=1, facets%n)]))
      if (.not. any(list(:n) == i) .or. any(list(2:n) <= list(:n - 1))) n_wrong = n_wrong + 1
    end do
    call suite%that('graded: all that contain a point are found, in order', n_wrong == 0)
  end subroutine check_graded


  subroutine check_empty(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    type(facet_search_type) :: search
    integer, allocatable :: element(:), face(:), list(:)
    integer :: n
    call flat_grid(FACET_QUAD4, 1, 1, mesh, element, face)
    call build_facets(mesh, element(:0), face(:0), facets, error)
    call suite%that('an empty surface is no error here', (.not. allocated(error)))
    call build_facet_search(facets, mesh%coordinates, 1.0_DP, search)
    call find_near_facets(search, [0.0_DP, 0.0_DP, 0.0_DP], list, n)
    call suite%that('and nothing is near', n == 0)
  end subroutine check_empty

end program test_facet_search
