!> Tests of facets: neighbours, kinds of edges, vertices, stars, stencils, and the errors of a bad surface.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_facets
  use amontons_kinds, only: DP, PI
  use amontons_errors, only: error_type, EXIT_SETUP
  use amontons_element_kinds, only: FACET_TRI3, FACET_QUAD4, FACET_TRI6, FACET_QUAD8, KIND_C3D6, KIND_C3D8, KIND_C3D10, &
    KIND_C3D20
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_facets, only: facets_type, build_facets, facet_nodes, facet_tangents, facet_label, EDGE_FREE, &
    EDGE_SMOOTH, EDGE_CONVEX, EDGE_CONCAVE
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer :: kind
  call check_grid(suite)
  do kind = FACET_TRI3, FACET_QUAD8
    call check_vertices(suite, kind, 0.0_DP)
    call check_vertices(suite, kind, 1.2_DP)
  end do
  call check_creases(suite)
  call check_fading_crease(suite)
  call check_errors(suite)
  call check_collapsed(suite)
  call suite%finish()

contains

  include 'sample_surfaces.inc'

  !> A flat grid of 3 x 3 squares with known topology.
  subroutine check_grid(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    integer, allocatable :: element(:), face(:), stencil(:)
    integer :: n, nodes(8), v
    real(DP) :: tangents(3, 2)
    call flat_grid(FACET_QUAD4, 3, 3, mesh, element, face)
    call build_facets(mesh, element, face, facets, error)
    call suite%that('the grid has no error', (.not. allocated(error)))
    call suite%that('9 facets', facets%n == 9)
    call suite%that('neighbours of the centre', all(facets%neighbour(:, 5) == [2, 6, 8, 4]))
    call suite%that('neighbours of a corner', all(facets%neighbour(:, 1) == [0, 2, 4, 0]))
    call suite%that('edges of a corner', all(facets%edge(:, 1) == [EDGE_FREE, EDGE_SMOOTH, EDGE_SMOOTH, EDGE_FREE]))
    call suite%that('one vertex for each of the 16 nodes', facets%n_vertices == 16)
    v = facets%vertex(facets%first(5))
    call suite%that('the star of an inner vertex', &
      all(facets%star_facet(facets%star_first(v):facets%star_first(v + 1) - 1) == [1, 2, 4, 5]))
    call suite%that('its local numbers', &
      all(facets%star_local(facets%star_first(v):facets%star_first(v + 1) - 1) == [3, 4, 2, 1]))
    call facet_nodes(facets, 5, n, nodes)
    call suite%that('nodes of the centre', n == 4 .and. all(nodes(:4) == [17, 19, 33, 31]))
    allocate (stencil, source=facets%stencil(facets%stencil_first(5):facets%stencil_first(6) - 1))
    call suite%that('the stencil of the centre', &
      all(stencil == [17, 19, 33, 31, 1, 3, 5, 7, 15, 21, 29, 35, 43, 45, 47, 49]))
    call suite%near('edge length', facets%edge_length(5), 1.0_DP, 1.0e-14_DP)
    call facet_tangents(facets, mesh%coordinates, 5, [0.3_DP, -0.2_DP], tangents)
    call suite%near('tangents', norm2(tangents - reshape([0.5_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.5_DP, 0.0_DP], [3, 2])), &
      0.0_DP, 1.0e-14_DP)
    call suite%that('label', facet_label(mesh, facets, 5) == 'element 105 face S2')
  end subroutine check_grid


  !> On any surface: neighbours are mutual, and facets with a smooth edge share the vertices on it, others do not.
  subroutine check_vertices(suite, kind, angle)
    type(suite_type), intent(inout) :: suite
    integer, intent(in) :: kind
    real(DP), intent(in) :: angle                    !< of a fold at x = 2 [rad]
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    integer, allocatable :: element(:), face(:)
    integer :: f, k, other, node, side, mine, its, n_corners, n_shared, n_wrong, n_creases
    character(40) :: name
    write (name, '(a,i0,a,f4.1)') 'kind ', kind, ' fold ', angle
    call flat_grid(kind, 4, 3, mesh, element, face)
    call shake(mesh, 0.2_DP, 0.02_DP)
    call fold(mesh, 2.03_DP, angle)
    call build_facets(mesh, element, face, facets, error)
    call suite%that(trim(name) // ' has no error', (.not. allocated(error)))
    if (allocated(error)) return
    n_corners = merge(3, 4, kind == FACET_TRI3 .or. kind == FACET_TRI6)
    n_shared = 0
    n_wrong = 0
    n_creases = count(facets%edge > EDGE_SMOOTH)
    do f = 1, facets%n
      do k = 1, n_corners
        other = facets%neighbour(k, f)
        if (other == 0) cycle
        if (.not. any(facets%neighbour(:, other) == f)) n_wrong = n_wrong + 1
        do side = 0, 1
          mine = facets%first(f) + modulo(k + side - 1, n_corners)
          node = facets%nodes(mine)
          its = facets%first(other) - 1 + &
            findloc(facets%nodes(facets%first(other):facets%first(other + 1) - 1), node, dim=1)
          if (facets%edge(k, f) == EDGE_SMOOTH .and. facets%vertex(mine) /= facets%vertex(its)) n_wrong = n_wrong + 1
          if (facets%edge(k, f) > EDGE_SMOOTH .and. facets%vertex(mine) == facets%vertex(its)) n_wrong = n_wrong + 1
          n_shared = n_shared + 1
        end do
      end do
    end do
    call suite%that(trim(name) // ': vertices follow the edges', n_shared > 40 .and. n_wrong == 0)
    call suite%that(trim(name) // ': creases', n_creases == merge(6, 0, angle > 1))
    call suite%that(trim(name) // ': every node of every facet is in a star', &
      size(facets%star_facet) == size(facets%nodes) .and. &
      facets%star_first(facets%n_vertices + 1) == size(facets%nodes) + 1)
  end subroutine check_vertices


  !> A fold is convex downward and concave upward, and smooth for a larger feature angle.
  subroutine check_creases(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh, flat
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    integer, allocatable :: element(:), face(:)
    call flat_grid(FACET_QUAD4, 2, 3, flat, element, face)
    mesh = flat
    call fold(mesh, 1.0_DP, PI / 2)
    call build_facets(mesh, element, face, facets, error)
    call suite%that('a ridge', &
      all(facets%edge(2, [1, 3, 5]) == EDGE_CONVEX) .and. all(facets%edge(4, [2, 4, 6]) == EDGE_CONVEX))
    call suite%that('a ridge doubles its vertices', facets%n_vertices == 12 + 4)
    mesh = flat
    call fold(mesh, 1.0_DP, -PI / 2)
    call build_facets(mesh, element, face, facets, error)
    call suite%that('a valley', all(facets%edge(2, [1, 3, 5]) == EDGE_CONCAVE))
    mesh = flat
    call fold(mesh, 1.0_DP, PI / 4 - 0.01_DP)
    call build_facets(mesh, element, face, facets, error)
    call suite%that('less than 45 degrees is smooth', &
      all(facets%edge(2, [1, 3, 5]) == EDGE_SMOOTH) .and. facets%n_vertices == 12)
    call build_facets(mesh, element, face, facets, error, feature_angle=PI / 4 - 0.02_DP)
    call suite%that('a smaller feature angle makes it a crease', all(facets%edge(2, [1, 3, 5]) == EDGE_CONVEX))
  end subroutine check_creases


  !> A crease that ends inside the surface: at its end there is one vertex, along it two.
  subroutine check_fading_crease(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    integer, allocatable :: element(:), face(:)
    integer :: j, i
    real(DP), parameter :: DEPTH(0:4) = [1.2_DP, 0.9_DP, 0.6_DP, 0.3_DP, 0.0_DP]
    call flat_grid(FACET_QUAD4, 2, 2, mesh, element, face)
    do j = 0, 4
      do i = 0, 4, 4                                 ! a roof along x = 1 whose sides rise to its height at y = 2
        mesh%coordinates(3, 1 + i + 5 * j) = -DEPTH(j)
      end do
    end do
    call build_facets(mesh, element, face, facets, error)
    call suite%that('the crease is there', facets%edge(2, 1) == EDGE_CONVEX .and. facets%edge(2, 3) == EDGE_SMOOTH)
    call suite%that('its end is one vertex', count_vertices(facets, 1 + 2 + 5 * 2) == 1)
    call suite%that('its start is two', count_vertices(facets, 1 + 2) == 2)
  end subroutine check_fading_crease


  !> Number of vertices at a mesh node.
  function count_vertices(facets, node) result(n)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: node
    integer :: n, k
    n = 0
    do k = 1, size(facets%nodes)
      if (facets%nodes(k) /= node) cycle
      if (any(facets%vertex(:k - 1) == facets%vertex(k))) cycle
      n = n + 1
    end do
  end function count_vertices


  !> Every error exit, and that its message names the user's elements.
  subroutine check_errors(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    integer, allocatable :: element(:), face(:)
    real(DP) :: x(3, 8)
    x = reshape(real([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 2, 0, 0, 2, 1, 0, 1, 0, 1, 1, 1, 1], DP), [3, 8])
    call mesh_of_facets(FACET_QUAD4, x, reshape([1, 2, 3, 4, 2, 3, 6, 5], [4, 2]), mesh, element, face)
    call expect_error(suite, mesh, element, face, 'not oriented', 'element 102 face S2')
    call mesh_of_facets(FACET_QUAD4, x, reshape([1, 2, 3, 4, 1, 2, 3, 4], [4, 2]), mesh, element, face)
    call expect_error(suite, mesh, element, face, 'same face', 'element 101 face S2')
    call mesh_of_facets(FACET_QUAD4, x, reshape([1, 2, 3, 4, 2, 5, 6, 3, 2, 7, 8, 3], [4, 3]), mesh, element, face)
    call expect_error(suite, mesh, element, face, 'more than two faces', 'element 103 face S2')
    call mesh_of_facets(FACET_QUAD4, x, reshape([2, 5, 6, 3, 1, 2, 3, 4, 2, 7, 8, 3], [4, 3]), mesh, element, face)
    call expect_error(suite, mesh, element, face, 'not oriented', 'element 103 face S2')
    call mesh_of_facets(FACET_QUAD4, x, reshape([1, 2, 2, 1], [4, 1]), mesh, element, face)
    call expect_error(suite, mesh, element, face, 'no area', 'element 101 face S2')
    call mesh_of_facets(FACET_TRI3, x, reshape([1, 2, 3], [3, 1]), mesh, element, face)
    call expect_error(suite, mesh, element, [6], 'S1 to S5', 'Element 101 of type C3D6')
    call expect_error(suite, mesh, [2], face, 'element index 2', '1 to 1')
  end subroutine check_errors


  subroutine expect_error(suite, mesh, element, face, one, two)
    type(suite_type), intent(inout) :: suite
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: element(:), face(:)
    character(*), intent(in) :: one, two             !< both must be in the message
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    call build_facets(mesh, element, face, facets, error)
    call suite%that('an error is found: ' // one, allocated(error))
    if (.not. allocated(error)) return
    call suite%that(error%message // ' : says ' // one, index(error%message, one) > 0)
    call suite%that(error%message // ' : says ' // two, index(error%message, two) > 0)
    call suite%that('its code', error%code == EXIT_SETUP)
  end subroutine expect_error


  !> A square collapsed to a triangle beside a square is a legal surface; its double node is in the stencil once.
  subroutine check_collapsed(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    integer, allocatable :: element(:), face(:)
    real(DP) :: x(3, 5)
    x = reshape(real([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 2, 0, 0], DP), [3, 5])
    call mesh_of_facets(FACET_QUAD4, x, reshape([1, 2, 3, 4, 2, 5, 3, 3], [4, 2]), mesh, element, face)
    call build_facets(mesh, element, face, facets, error)
    call suite%that('a collapsed facet is no error', (.not. allocated(error)))
    if (allocated(error)) return
    call suite%that('its neighbour', facets%neighbour(2, 1) == 2 .and. facets%neighbour(4, 2) == 1)
    call suite%that('its stencil', all(facets%stencil(facets%stencil_first(2):) == [2, 5, 3, 1, 4]))
  end subroutine check_collapsed

end program test_facets
