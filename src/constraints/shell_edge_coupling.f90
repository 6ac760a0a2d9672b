!> Edges of shells coupled to faces of solids (SHELL TO SOLID COUPLING), as linear equations.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Over the thickness an edge stays straight: u = sum F_J u_J, with J the bottom and top of its fibres. It moves as the solid in
!! front of it in the weak sense,
!!
!!     integral of phi_I (u - u_solid) = 0,   integral of phi_I F_J = D_I delta_IJ
!!
!! so that u_I = sum w_Ia u_a over the nodes of the solid, w_Ia = (integral of phi_I N_a) / D_I. The weights reproduce linear
!! fields, so the equations hold at any rotation, and stress that is constant along the edge and linear over the thickness passes.
!! The integrals are those of mortar contact: the solid may have any mesh. Theory: doc/theory/elements.md.
module amontons_shell_edge_coupling
  use amontons_containers, only: list_groups
  use amontons_dense, only: invert_small, DENSE_OK
  use amontons_element_kinds, only: MAX_FACE_NODES
  use amontons_errors, only: error_type, set_error, EXIT_SETUP
  use amontons_facet_search, only: facet_search_type, build_facet_search
  use amontons_facets, only: facets_type, build_facets, facet_nodes
  use amontons_kinds, only: DP
  use amontons_loads, only: equation_list_type
  use amontons_mesh, only: mesh_type
  use amontons_model, only: model_type, new_equation
  use amontons_mortar_segmentation, only: projection_plane_type, segmentation_type, build_segmentation, build_projection_planes
  use amontons_mpc_data, only: tie_type
  use amontons_shape_functions, only: facet_shapes
  use amontons_structural_data, only: structure_type, following_nodes
  use amontons_tensor, only: cross_product
  use amontons_text, only: to_text
  implicit none
  private
  public :: couple_shell_edge

  character(*), parameter :: CARD = 'SHELL TO SOLID COUPLING'
  real(DP), parameter :: TOL_DISTANCE = 0.05_DP      !< default of POSITION TOLERANCE, over the mean edge of a facet [-]
  real(DP), parameter :: MIN_COVER = 0.25_DP         !< an edge with less of its area before the solid is not coupled [-]
  integer, parameter :: MAX_EDGE_FUNCTIONS = 6            !< F_J of an edge: two fibres, of quadratic elements three

  !> The bottom or the top of a fibre, as the mean of nodes of the solid.
  type :: fibre_end_type
    real(DP) :: share = 0                            !< integral of F_J over the part that is before the solid [length^2]
    integer :: n = 0
    integer, allocatable :: nodes(:)                 !< of the solid: the first n are set
    real(DP), allocatable :: weight(:)               !< integral of phi_J N_a [length^2]
  end type fibre_end_type

  !> Integration points of one edge.
  type :: edge_points_type
    integer :: n = 0
    real(DP), allocatable :: weight(:)               !< [length^2]
    integer, allocatable :: facet(:)                 !< of the solid
    real(DP), allocatable :: F(:, :)                 !< (MAX_EDGE_FUNCTIONS, n) F_J [-]
    real(DP), allocatable :: on_solid(:, :)          !< (MAX_FACE_NODES, n) N_a of the facet of the solid [-]
  end type edge_points_type

  !> The fibres of the edge.
  type :: fibres_type
    integer :: n = 0
    integer, allocatable :: of_node(:)               !< (n_nodes of the mesh) fibre of a node; 0: none
    real(DP), allocatable :: place(:)                !< (n_nodes) over the thickness: 0 at the bottom, 1 on top [-]
    type(fibre_end_type), allocatable :: ends(:, :)  !< (2, n)
  end type fibres_type

contains

  !> The equations of one coupling; nodes of the edge are moved to the places that their equations give them.
  !!
  !! Errors: EXIT_SETUP, where no node of the edge has the solid in front of it.
  subroutine couple_shell_edge(model, tie, mesh, equations, text, error)
    type(model_type), intent(in) :: model
    type(tie_type), intent(in) :: tie                !< its slave surface consists of edges of shells
    type(mesh_type), intent(inout) :: mesh
    type(equation_list_type), intent(inout) :: equations
    character(:), allocatable, intent(inout) :: text !< nodes that are not coupled are added
    type(error_type), allocatable, intent(out) :: error
    type(facets_type) :: edges, solid
    type(facet_search_type) :: search
    type(fibres_type) :: fibres
    integer, allocatable :: first(:), members(:), edge_of(:)
    real(DP) :: reach
    integer :: k
    associate (slave => model%surfaces(tie%slave), master => model%surfaces(tie%master))
      call build_facets(mesh, slave%element, slave%face, edges, error)
      if (.not. allocated(error)) call build_facets(mesh, master%element, master%face, solid, error)
      if (allocated(error)) return
      call collect_fibres(model%structure, slave%nodes, mesh%n_nodes, fibres)
    end associate
    reach = tie%tolerance
    if (tie%tolerance < 0.0_DP) reach = TOL_DISTANCE * sum(edges%edge_length) / real(edges%n, DP)
    call build_facet_search(solid, mesh%coordinates, reach + 2 * maxval(edges%edge_length), search)
    edge_of = number_edges(edges, fibres)
    call list_groups(edge_of, maxval(edge_of), first, members)
    associate (planes => build_projection_planes(solid, mesh%coordinates))
      do k = 1, size(first) - 1
        call integrate_edge(edges, members(first(k):first(k + 1) - 1), solid, planes, search, mesh%coordinates, reach, fibres)
      end do
    end associate
    call add_equations(model, tie, fibres, mesh, equations, text, error)
  end subroutine couple_shell_edge


  !> The fibres with nodes of the edge.
  pure subroutine collect_fibres(structure, nodes, n_nodes, fibres)
    type(structure_type), intent(in) :: structure
    integer, intent(in) :: nodes(:)                  !< of the edge
    integer, intent(in) :: n_nodes                   !< of the mesh
    type(fibres_type), intent(out) :: fibres
    logical :: is_on_edge(n_nodes)
    integer :: i
    is_on_edge = .false.
    is_on_edge(nodes) = .true.
    allocate (fibres%of_node(n_nodes), source=0)
    allocate (fibres%place(n_nodes), source=0.0_DP)
    do i = 1, size(structure%directors)
      associate (director => structure%directors(i))
        if (director%n_outer /= 2 .or. .not. any(is_on_edge(director%nodes))) cycle
        fibres%n = fibres%n + 1
        fibres%of_node(director%nodes) = fibres%n
        fibres%place(director%nodes) = director%place
      end associate
    end do
    allocate (fibres%ends(2, fibres%n))
    do i = 1, fibres%n
      allocate (fibres%ends(1, i)%nodes(16), fibres%ends(2, i)%nodes(16), source=0)
      allocate (fibres%ends(1, i)%weight(16), fibres%ends(2, i)%weight(16), source=0.0_DP)
    end do
  end subroutine collect_fibres


  !> The edge to which each facet belongs: those of all layers of an edge have the same fibres.
  pure function number_edges(facets, fibres) result(edge_of)
    type(facets_type), intent(in) :: facets
    type(fibres_type), intent(in) :: fibres
    integer :: edge_of(facets%n)
    integer :: ends(2, facets%n), latest(fibres%n), before(facets%n), f, g, n
    latest = 0                                       ! the last edge that begins at a fibre; before: the one before that
    n = 0
    do f = 1, facets%n
      associate (own => fibres%of_node(facets%nodes(facets%first(f):facets%first(f) + 3)))
        ends(:, f) = [minval(own), maxval(own)]
      end associate
      g = latest(ends(1, f))
      do while (g > 0)
        if (ends(2, g) == ends(2, f)) exit
        g = before(g)
      end do
      if (g > 0) then
        edge_of(f) = edge_of(g)
      else
        n = n + 1
        edge_of(f) = n
        before(f) = latest(ends(1, f))
        latest(ends(1, f)) = f
      end if
    end do
  end function number_edges


  !> Adds the integrals over one edge to the ends of its fibres.
  subroutine integrate_edge(edges, layers, solid, planes, search, x, reach, fibres)
    type(facets_type), intent(in) :: edges, solid
    integer, intent(in) :: layers(:)                 !< facets of the edge
    type(projection_plane_type), intent(in) :: planes(:)   !< (solid%n)
    type(facet_search_type), intent(in) :: search
    real(DP), intent(in) :: x(:, :), reach
    type(fibres_type), intent(inout) :: fibres
    type(edge_points_type) :: points
    real(DP), allocatable :: mass(:, :), inverse(:, :), share(:), phi(:, :)
    integer :: own(MAX_EDGE_FUNCTIONS / 2), n, q, j, status
    call list_edge_points(edges, layers, solid, planes, search, x, reach, fibres, points)
    own = list_fibres(edges, layers(1), fibres)
    n = 2 * count(own > 0)
    share = matmul(points%F(:n, :), points%weight)
    if (sum(share) < MIN_COVER * sum([(facet_area(edges, layers(j), x), j=1, size(layers))])) return
    allocate (inverse(n, n))
    mass = matmul(points%F(:n, :) * spread(points%weight, 1, n), transpose(points%F(:n, :)))
    call invert_small(mass, inverse, status)
    if (status /= DENSE_OK) return
    phi = matmul(inverse, points%F(:n, :)) * spread(share, 2, points%n)
    do j = 1, n
      associate (end => fibres%ends(2 - modulo(j, 2), own((j + 1) / 2)))
        end%share = end%share + share(j)
        do q = 1, points%n
          call add_weights(solid, points%facet(q), points%weight(q) * phi(j, q) * points%on_solid(:, q), end)
        end do
      end associate
    end do
  end subroutine integrate_edge


  !> The integration points of one edge that lie before the solid.
  subroutine list_edge_points(edges, layers, solid, planes, search, x, reach, fibres, points)
    type(facets_type), intent(in) :: edges, solid
    integer, intent(in) :: layers(:)                 !< facets of the edge
    type(projection_plane_type), intent(in) :: planes(:)   !< (solid%n)
    type(facet_search_type), intent(in) :: search
    real(DP), intent(in) :: x(:, :), reach
    type(fibres_type), intent(in) :: fibres
    type(edge_points_type), intent(out) :: points
    type(segmentation_type) :: cut
    integer :: l, s, q, own(MAX_EDGE_FUNCTIONS / 2)
    own = list_fibres(edges, layers(1), fibres)
    allocate (points%weight(0), points%facet(0), points%F(MAX_EDGE_FUNCTIONS, 0), points%on_solid(MAX_FACE_NODES, 0))
    do l = 1, size(layers)
      call build_segmentation(edges, layers(l), 1.0_DP, solid, planes, search, x, reach, cut)
      do s = 1, cut%n
        associate (first => cut%segments(s)%first, last => cut%segments(s)%last)
          points%weight = [points%weight, cut%points%weight(first:last)]
          points%facet = [points%facet, spread(cut%segments(s)%master, 1, last - first + 1)]
          points%on_solid = reshape([points%on_solid, cut%points%on_master(:, first:last)], [MAX_FACE_NODES, size(points%weight)])
          points%F = reshape([points%F, [(edge_functions(edges, layers(l), cut%points%xi(:, q), fibres, own), q=first, last)]], &
            [MAX_EDGE_FUNCTIONS, size(points%weight)])
        end associate
      end do
    end do
    points%n = size(points%weight)
  end subroutine list_edge_points


  !> The fibres of a facet; the rest is 0.
  pure function list_fibres(edges, f, fibres) result(own)
    type(facets_type), intent(in) :: edges
    integer, intent(in) :: f                         !< facet
    type(fibres_type), intent(in) :: fibres
    integer :: own(MAX_EDGE_FUNCTIONS / 2), k, n
    own = 0
    n = 0
    do k = edges%first(f), edges%first(f + 1) - 1
      associate (fibre => fibres%of_node(edges%nodes(k)))
        if (any(own == fibre)) cycle
        n = n + 1
        own(n) = fibre
      end associate
    end do
  end function list_fibres


  !> F_J of an edge at a point of one of its facets: bottom and top of the first fibre, and so on.
  pure function edge_functions(edges, f, xi, fibres, own) result(F_J)
    type(facets_type), intent(in) :: edges
    integer, intent(in) :: f                         !< facet
    real(DP), intent(in) :: xi(2)                    !< natural coordinates there [-]
    type(fibres_type), intent(in) :: fibres
    integer, intent(in) :: own(:)                    !< fibres of the edge; 0: none
    real(DP) :: F_J(MAX_EDGE_FUNCTIONS), N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    integer :: nodes(MAX_FACE_NODES), n_nodes, i, k
    call facet_nodes(edges, f, n_nodes, nodes)
    call facet_shapes(edges%kind(f), xi, N, dN, ddN)
    F_J = 0
    do i = 1, n_nodes
      k = findloc(own, fibres%of_node(nodes(i)), dim=1)
      associate (place => fibres%place(nodes(i)))
        F_J(2 * k - 1:2 * k) = F_J(2 * k - 1:2 * k) + N(i) * [1 - place, place]
      end associate
    end do
  end function edge_functions


  !> The area of a facet with four corners.
  pure real(DP) function facet_area(edges, f, x) result(area)
    type(facets_type), intent(in) :: edges
    integer, intent(in) :: f                         !< facet
    real(DP), intent(in) :: x(:, :)                  !< [length]
    associate (corner => edges%nodes(edges%first(f):edges%first(f) + 3))
      area = norm2(cross_product(x(:, corner(3)) - x(:, corner(1)), x(:, corner(4)) - x(:, corner(2)))) / 2
    end associate
  end function facet_area


  !> Adds weights of the nodes of a facet of the solid.
  pure subroutine add_weights(solid, f, weight, end)
    type(facets_type), intent(in) :: solid
    integer, intent(in) :: f                         !< facet
    real(DP), intent(in) :: weight(:)                !< of its nodes [length^2]
    type(fibre_end_type), intent(inout) :: end
    integer :: nodes(MAX_FACE_NODES), n, i, k
    call facet_nodes(solid, f, n, nodes)
    do i = 1, n
      k = findloc(end%nodes(:end%n), nodes(i), dim=1)
      if (k == 0) then
        if (end%n == size(end%nodes)) then
          end%nodes = [end%nodes, spread(0, 1, end%n)]
          end%weight = [end%weight, spread(0.0_DP, 1, end%n)]
        end if
        end%n = end%n + 1
        k = end%n
        end%nodes(k) = nodes(i)
      end if
      end%weight(k) = end%weight(k) + weight(i)
    end do
  end subroutine add_weights


  !> The equations of all nodes of the edge, but for those that follow others of their fibre anyway.
  subroutine add_equations(model, tie, fibres, mesh, equations, text, error)
    type(model_type), intent(in) :: model
    type(tie_type), intent(in) :: tie
    type(fibres_type), intent(in) :: fibres
    type(mesh_type), intent(inout) :: mesh
    type(equation_list_type), intent(inout) :: equations
    character(:), allocatable, intent(inout) :: text
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: nodes(:)
    real(DP), allocatable :: weight(:)
    real(DP) :: x(3, mesh%n_nodes)
    logical :: follows(mesh%n_nodes)
    integer :: i, k, n_coupled, n_left
    x = mesh%coordinates
    follows = following_nodes(model%structure, mesh%n_nodes)
    n_coupled = 0
    n_left = 0
    do i = 1, mesh%n_nodes
      if (fibres%of_node(i) == 0) cycle
      associate (bottom => fibres%ends(1, fibres%of_node(i)), top => fibres%ends(2, fibres%of_node(i)), place => fibres%place(i))
        if (.not. min(bottom%share, top%share) > 0) then
          n_left = n_left + 1
          cycle
        end if
        n_coupled = n_coupled + 1
        nodes = [bottom%nodes(:bottom%n), top%nodes(:top%n)]
        weight = [(1 - place) / bottom%share * bottom%weight(:bottom%n), place / top%share * top%weight(:top%n)]
        call merge_equal(nodes, weight)
        mesh%coordinates(:, i) = matmul(x(:, nodes), weight)
        if (follows(i)) cycle
        do k = 1, 3
          call equations%add(new_equation([i, nodes], spread(k, 1, size(nodes) + 1), [1.0_DP, -weight], CARD, tie%line))
        end do
      end associate
    end do
    if (n_coupled == 0) then
      call set_error(error, EXIT_SETUP, 'The *' // CARD // ' in line ' // to_text(tie%line) // ' couples nothing: no edge has ' // &
        'the solid in front of it within POSITION TOLERANCE.')
    else if (n_left > 0) then
      text = text // 'The *' // CARD // ' in line ' // to_text(tie%line) // ' leaves fibres of the edge free: ' // &
        'they have no solid in front of them within POSITION TOLERANCE. '
    end if
  end subroutine add_equations


  !> Adds up the weights of nodes that a list contains twice.
  pure subroutine merge_equal(nodes, weight)
    integer, allocatable, intent(inout) :: nodes(:)
    real(DP), allocatable, intent(inout) :: weight(:)
    integer :: i, k
    do i = size(nodes), 2, -1
      k = findloc(nodes(:i - 1), nodes(i), dim=1)
      if (k == 0) cycle
      weight(k) = weight(k) + weight(i)
      nodes(i) = 0
    end do
    weight = pack(weight, nodes > 0)
    nodes = pack(nodes, nodes > 0)
  end subroutine merge_equal

end module amontons_shell_edge_coupling
