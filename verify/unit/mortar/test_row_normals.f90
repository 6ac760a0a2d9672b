!> Unit test of amontons_row_normals: directions of a cone in closed form, normals at the creases of a tilted cube, and their
!! derivatives against differences.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_row_normals
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_shape_functions, only: node_coordinates
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_facets, only: facets_type, build_facets
  use amontons_facet_search, only: facet_search_type, build_facet_search
  use amontons_mortar, only: mortar_type, create_mortar, integrate_mortar, find_search_margin, vertices_of
  use amontons_row_normals, only: normal_cone_type, find_row_normal, differentiate_row_normal, project_on_cone
  use amontons_segment_derivatives, only: facet_derivatives_type
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  real(DP), parameter :: FLAT = 0.0_DP, WAVES = 0.1_DP   !< height of the master's waves [length]
  call check_cones()
  call check_cube(0.5_DP, -0.1_DP, FLAT, 2)   ! not 0: there the side in y is at the border of the cone
  call check_cube(0.5_DP, 0.3_DP, FLAT, 3)
  call check_cube(0.5_DP, -0.1_DP, WAVES, 2)
  call check_cube(0.5_DP, 0.3_DP, WAVES, 3)
  call suite%finish()

contains

  !> The projections on a quadrant and on an octant.
  subroutine check_cones()
    type(normal_cone_type) :: cone
    cone%n = 2
    cone%rays(:, 1) = [1.0_DP, 0.0_DP, 0.0_DP]
    cone%rays(:, 2) = [0.0_DP, 1.0_DP, 0.0_DP]
    cone%target = [3.0_DP, 2.0_DP, 1.0_DP]
    call project_on_cone(cone)
    call suite%near('a quadrant: within', norm2(cone%q - [3.0_DP, 2.0_DP, 0.0_DP]), 0.0_DP, 1.0e-14_DP)
    call suite%that('a quadrant: two rays', cone%n_active == 2)
    cone%target = [3.0_DP, -2.0_DP, 1.0_DP]
    call project_on_cone(cone)
    call suite%near('a quadrant: beside', norm2(cone%q - [3.0_DP, 0.0_DP, 0.0_DP]), 0.0_DP, 1.0e-14_DP)
    call suite%that('a quadrant: one ray', cone%n_active == 1 .and. cone%active(1) == 1)
    cone%target = [-3.0_DP, -2.0_DP, 1.0_DP]
    call project_on_cone(cone)
    call suite%that('a quadrant: away', cone%n_active == 0)
    cone%n = 3
    cone%rays(:, 3) = [0.0_DP, 0.0_DP, 1.0_DP]
    cone%target = [3.0_DP, 2.0_DP, 1.0_DP]
    call project_on_cone(cone)
    call suite%near('an octant: within', norm2(cone%q - cone%target), 0.0_DP, 1.0e-14_DP)
    cone%target = [-1.0_DP, 2.0_DP, 1.0_DP]
    call project_on_cone(cone)
    call suite%near('an octant: beside', norm2(cone%q - [0.0_DP, 2.0_DP, 1.0_DP]), 0.0_DP, 1.0e-14_DP)
    cone%rays(:, 3) = cone%rays(:, 1)              ! the sides of a slot: two of three rays agree
    cone%target = [3.0_DP, 2.0_DP, 1.0_DP]
    call project_on_cone(cone)
    call suite%near('dependent rays', norm2(cone%q - [3.0_DP, 2.0_DP, 0.0_DP]), 0.0_DP, 1.0e-14_DP)
  end subroutine check_cones


  !> A cube with its bottom and two sides as slave, turned about y and x, over four masters with waves.
  subroutine make_cube(about_y, about_x, sag, mesh, master, search, mortar)
    real(DP), intent(in) :: about_y, about_x       !< [rad]
    real(DP), intent(in) :: sag                    !< height of the waves [length]
    type(mesh_type), intent(out) :: mesh
    type(facets_type), intent(out) :: master
    type(facet_search_type), intent(out) :: search
    type(mortar_type), intent(out) :: mortar
    type(error_type), allocatable :: error
    real(DP) :: xi(3, 20), unit_cube(3, 8), y_turn(3, 3), x_turn(3, 3)
    integer :: i, n, node
    n = 5
    mesh%n_elements = n
    mesh%kind = spread(KIND_C3D8, 1, n)
    mesh%material = spread(1, 1, n)
    mesh%first = [(8 * i + 1, i=0, n)]
    mesh%element_label = [(i, i=1, n)]
    call node_coordinates(KIND_C3D8, xi)
    unit_cube = 0.5_DP * (xi(:, :8) + 1)
    mesh%n_nodes = 8 + 18
    mesh%node_label = [(i, i=1, mesh%n_nodes)]
    allocate (mesh%node_sets(0), mesh%element_sets(0), mesh%coordinates(3, mesh%n_nodes), mesh%nodes(8 * n))
    mesh%nodes(:8) = [(i, i=1, 8)]
    do i = 0, 17                                   ! two layers of nine nodes
      mesh%coordinates(:, 9 + i) = [-1.1_DP, -1.3_DP, -1.0_DP] + [1.6_DP, 1.7_DP, 1.0_DP] * real([mod(i, 3), mod(i, 9) / 3, &
        i / 9], DP)
    end do
    do i = 0, 3
      node = 9 + mod(i, 2) + 3 * (i / 2)
      mesh%nodes(8 * i + 9:8 * i + 16) = node + [0, 1, 4, 3, 9, 10, 13, 12]
    end do
    mesh%coordinates(3, 18:) = sag * sin(2 * mesh%coordinates(1, 18:)) * cos(mesh%coordinates(2, 18:) - 0.3_DP)
    y_turn = reshape([cos(about_y), 0.0_DP, -sin(about_y), 0.0_DP, 1.0_DP, 0.0_DP, sin(about_y), 0.0_DP, cos(about_y)], [3, 3])
    x_turn = reshape([1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, cos(about_x), -sin(about_x), 0.0_DP, sin(about_x), cos(about_x)], [3, 3])
    mesh%coordinates(:, :8) = 0.7_DP * matmul(x_turn, matmul(y_turn, unit_cube))
    mesh%coordinates(3, :8) = mesh%coordinates(3, :8) - minval(mesh%coordinates(3, :8)) + 0.12_DP
    call finalize_mesh(mesh)
    call create_mortar(mesh, [1, 1, 1], [1, 4, 5], [1, 2, 3, 4, 6, 7, 8], mortar, error)
    call suite%that('the slave is made', .not. allocated(error))
    call build_facets(mesh, [2, 3, 4, 5], [2, 2, 2, 2], master, error)
    call suite%that('the master is made', .not. allocated(error))
    call build_facet_search(master, mesh%coordinates, find_search_margin(mortar, 1.0_DP), search)
    call integrate_mortar(mortar, master, search, .true., mesh%coordinates, 1.0_DP)
  end subroutine make_cube


  !> Normals and their derivatives. At most `n_rays` rays are active, and somewhere so many.
  subroutine check_cube(about_y, about_x, sag, n_rays)
    real(DP), intent(in) :: about_y, about_x, sag
    integer, intent(in) :: n_rays
    type(mesh_type) :: mesh
    type(facets_type) :: master
    type(facet_search_type) :: search
    type(mortar_type) :: mortar
    type(normal_cone_type) :: cone
    type(facet_derivatives_type), allocatable :: facet_derivatives(:)
    real(DP), allocatable :: x(:, :), d_n(:, :, :)
    real(DP) :: normal(3), edge(3), expected(3)
    integer, allocatable :: nodes(:)
    integer :: j, n_largest
    call make_cube(about_y, about_x, sag, mesh, master, search, mortar)
    allocate (facet_derivatives(mortar%slave%n))
    x = mesh%coordinates
    n_largest = 0
    do j = 1, size(mortar%nodes)
      if (mortar%places(j)%facet == 0) cycle
      call find_row_normal(mortar%slave, vertices_of(mortar, j), mortar%places(j)%vertex, mortar%cuts%covers, master, x, normal, &
        cone)
      n_largest = max(n_largest, cone%n_active)
      call suite%near('the normal of the row', norm2(mortar%places(j)%normal + normal), 0.0_DP, 1.0e-14_DP)
      call suite%near('a unit normal', norm2(normal), 1.0_DP, 1.0e-14_DP)
      expected = -[0.0_DP, 0.0_DP, 1.0_DP]         ! a corner: that of the master; an edge: the part of it across the edge
      edge = (x(:, 3) - x(:, 2)) / norm2(x(:, 3) - x(:, 2))
      if (cone%n_active == 2) expected = expected - dot_product(expected, edge) * edge
      if (sag <= 0.0_DP .and. any(mortar%nodes(j) == [2, 3]) .and. cone%n_active > 1) &
        call suite%near('the normal over a flat master', norm2(normal - expected / norm2(expected)), 0.0_DP, 1.0e-12_DP)
      call differentiate_row_normal(mortar%slave, vertices_of(mortar, j), mortar%places(j)%vertex, mortar%cuts%covers, master, x, &
        facet_derivatives, nodes, d_n)
      call check_differences(mortar, master, search, x, j, nodes, d_n)
    end do
    call suite%that('so many rays', n_largest == n_rays)
  end subroutine check_cube


  !> All nodes of the mesh: those not in the list do not change the normal.
  subroutine check_differences(mortar, master, search, x, j, nodes, d_n)
    type(mortar_type), intent(in) :: mortar
    type(facets_type), intent(in) :: master
    type(facet_search_type), intent(in) :: search
    real(DP), intent(in) :: x(:, :), d_n(:, :, :)
    integer, intent(in) :: j                       !< row
    integer, intent(in) :: nodes(:)
    real(DP), parameter :: STEP = 1.0e-6_DP
    type(mortar_type) :: moved
    real(DP), allocatable :: y(:, :)
    real(DP) :: normals(3, 2), rate(3), largest
    integer :: node, i, k, side
    largest = 0.0_DP
    do node = 1, size(x, 2)
      k = findloc(nodes, node, dim=1)
      do i = 1, 3
        do side = 1, 2
          y = x
          y(i, node) = y(i, node) + merge(STEP, -STEP, side == 1)
          moved = mortar
          call integrate_mortar(moved, master, search, .true., y, 1.0_DP)
          normals(:, side) = -moved%places(j)%normal
        end do
        rate = 0.0_DP
        if (k > 0) rate = d_n(:, i, k)
        largest = max(largest, maxval(abs((normals(:, 1) - normals(:, 2)) / (2 * STEP) - rate)))
      end do
    end do
    call suite%near('derivatives of the normal', largest, 0.0_DP, 1.0e-7_DP)
  end subroutine check_differences

end program test_row_normals
