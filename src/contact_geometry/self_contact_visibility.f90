!> Self contact: the facets of a surface that a node of the same surface cannot touch, and the current normal of the node.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A node does not see the facets near it *on* the surface, within a geodesic distance of 1.5 edges: the facets at the node and
!! those around them, unless a node of theirs is much nearer through space, as across a slot. Nor does it see the facets on the
!! other side of the material: facets that it lies behind in the reference configuration, by up to two depths of the elements there.
!! (Such a facet of a sheet opposes the node, and a sheet that is squeezed would touch itself through its own thickness.) Geodesic
!! distances are lengths of paths over edges and diagonals of the facets. Cost: linear, if the facets of a neighbourhood are few.
module amontons_self_contact_visibility
  use amontons_kinds, only: DP
  use amontons_tensor, only: cross_product
  use amontons_element_kinds, only: MAX_FACE_NODES
  use amontons_containers, only: integer_list_type, list_groups, owners_of_entries
  use amontons_facets, only: facets_type, facet_nodes, facet_tangents, facet_centre, n_facet_corners
  use amontons_facet_search, only: facet_search_type, build_facet_search, find_near_facets
  use amontons_surface_projection, only: MIN_OPPOSED_COSINE
  implicit none
  private
  public :: find_unseen_facets, current_node_normal

  real(DP), parameter :: GEODESIC_RADIUS = 1.5_DP      !< over the longest edge at the node [-]
  real(DP), parameter :: MIN_DETOUR = 3.0_DP           !< least geodesic over straight distance of nodes that see each other [-]
  real(DP), parameter :: MIN_MATERIAL_SHARE = 0.3_DP   !< a facet that lies behind by less, over the depth of its element, overlaps
  real(DP), parameter :: MAX_MATERIAL_SHARE = 2.0_DP   !< deeper facets are hidden by their depth alone [-]

contains

  !> Lists the facets that each node of the surface does not see, and the facets at each node.
  subroutine find_unseen_facets(x, depth, facets)
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) reference coordinates [length]
    real(DP), intent(in) :: depth(:)               !< (n) of the elements below the facets [length]
    type(facets_type), intent(inout) :: facets
    type(facet_search_type) :: search
    type(integer_list_type) :: found
    real(DP), allocatable :: distance(:)
    integer, allocatable :: list(:)
    integer :: node, k, n
    call list_facets_at_nodes(size(x, 2), facets)
    call build_facet_search(facets, x, MAX_MATERIAL_SHARE * maxval(depth), search)
    allocate (distance(size(x, 2)), source=huge(1.0_DP))
    allocate (facets%unseen_first(size(x, 2) + 1), found%items(16 * facets%n + 16))
    facets%unseen_first(1) = 1
    do node = 1, size(x, 2)
      if (facets%at_first(node + 1) > facets%at_first(node)) then
        call add_facets_beside(facets, x, node, distance, found)
        call find_near_facets(search, x(:, node), list, n)
        do k = 1, n
          if (is_behind_material(facets, x, depth(list(k)), node, list(k))) call found%add(list(k))
        end do
      end if
      facets%unseen_first(node + 1) = found%n + 1
    end do
    facets%unseen = found%trimmed()
  end subroutine find_unseen_facets


  !> The facets at each node of the mesh.
  subroutine list_facets_at_nodes(n_nodes, facets)
    integer, intent(in) :: n_nodes
    type(facets_type), intent(inout) :: facets
    integer, allocatable :: owner(:)
    owner = owners_of_entries(facets%first(:facets%n + 1))
    call list_groups(facets%nodes, n_nodes, facets%at_first, facets%at)
    facets%at = owner(facets%at)
  end subroutine list_facets_at_nodes


  !> Adds the facets within the geodesic radius of a node (E. Dijkstra, Numer. Math. 1 (1959) 269-271). A facet is as far as its
  !! nearest node.
  subroutine add_facets_beside(facets, x, node, distance, found)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    integer, intent(in) :: node
    real(DP), intent(inout) :: distance(:)         !< (n_nodes) huge, before and after [length]
    type(integer_list_type), intent(inout) :: found
    integer :: reached(200), n_reached, i, k, j, a, b, nearest
    logical :: is_done(200)
    real(DP) :: radius
    radius = GEODESIC_RADIUS * maxval(facets%edge_length(facets%at(facets%at_first(node):facets%at_first(node + 1) - 1)))
    is_done = .false.
    n_reached = 1
    reached(1) = node
    distance(node) = 0.0_DP
    do i = 1, size(reached)
      nearest = 0
      do k = 1, n_reached
        if (is_done(k)) cycle
        if (nearest == 0) nearest = k
        if (distance(reached(k)) < distance(reached(nearest))) nearest = k
      end do
      if (nearest == 0) exit
      is_done(nearest) = .true.
      a = reached(nearest)
      do k = facets%at_first(a), facets%at_first(a + 1) - 1
        do j = facets%first(facets%at(k)), facets%first(facets%at(k) + 1) - 1
          b = facets%nodes(j)
          if (distance(a) + norm2(x(:, b) - x(:, a)) > min(radius, distance(b))) cycle
          if (distance(b) >= huge(1.0_DP)) then
            if (n_reached == size(reached)) cycle
            n_reached = n_reached + 1
            reached(n_reached) = b
          end if
          distance(b) = min(distance(b), distance(a) + norm2(x(:, b) - x(:, a)))
        end do
      end do
    end do
    call add_unseen_facets(facets, x, node, reached(:n_reached), distance, radius, found)
    distance(reached(:n_reached)) = huge(1.0_DP)
  end subroutine add_facets_beside


  !> Adds the facets at the nodes reached, each once: those at the node itself, and those without a detour to any of their nodes.
  subroutine add_unseen_facets(facets, x, node, reached, distance, radius, found)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    integer, intent(in) :: node
    integer, intent(in) :: reached(:)              !< nodes within the radius
    real(DP), intent(in) :: distance(:)            !< (n_nodes) geodesic, huge beyond the radius [length]
    real(DP), intent(in) :: radius                 !< [length]
    type(integer_list_type), intent(inout) :: found
    integer :: first, i, k
    first = found%n + 1
    do i = 1, size(reached)
      do k = facets%at_first(reached(i)), facets%at_first(reached(i) + 1) - 1
        associate (f => facets%at(k))
          if (any(found%items(first:found%n) == f)) cycle
          if (.not. has_detour(facets%nodes(facets%first(f):facets%first(f + 1) - 1))) call found%add(f)
        end associate
      end do
    end do

  contains

    !> Whether the way over the surface to a node of a facet is much longer than the straight one.
    pure logical function has_detour(nodes)
      integer, intent(in) :: nodes(:)
      integer :: j
      has_detour = .false.
      if (any(nodes == node)) return
      do j = 1, size(nodes)
        has_detour = has_detour .or. min(distance(nodes(j)), radius) > MIN_DETOUR * norm2(x(:, nodes(j)) - x(:, node))
      end do
    end function has_detour

  end subroutine add_unseen_facets


  !> Whether the material lies between a node and a facet in the reference configuration: their normals oppose, and the node is
  !! behind the facet.
  pure logical function is_behind_material(facets, x, depth, node, f)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    real(DP), intent(in) :: depth                  !< of the element below the facet [length]
    integer, intent(in) :: node
    integer, intent(in) :: f
    real(DP) :: normal(3), between(3), behind
    integer :: n, nodes(MAX_FACE_NODES)
    normal = facet_normal(facets, x, f)
    normal = normal / max(norm2(normal), tiny(1.0_DP))
    call facet_nodes(facets, f, n, nodes)
    n = n_facet_corners(facets%kind(f))
    between = x(:, node) - sum(x(:, nodes(:n)), dim=2) / real(n, DP)
    behind = -dot_product(between, normal)
    is_behind_material = behind > MIN_MATERIAL_SHARE * depth .and. behind < MAX_MATERIAL_SHARE * depth
    is_behind_material = is_behind_material .and. dot_product(normal, current_node_normal(facets, x, node)) < -MIN_OPPOSED_COSINE
    is_behind_material = is_behind_material .and. norm2(between + behind * normal) <= facets%edge_length(f) + depth
  end function is_behind_material


  !> The mean normal of the facets at a node.
  pure function current_node_normal(facets, x, node) result(normal)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates now [length]
    integer, intent(in) :: node
    real(DP) :: normal(3)
    integer :: k
    normal = 0.0_DP
    do k = facets%at_first(node), facets%at_first(node + 1) - 1
      normal = normal + facet_normal(facets, x, facets%at(k))
    end do
    normal = normal / max(norm2(normal), tiny(1.0_DP))
  end function current_node_normal


  !> The outward normal at the centre of a facet, not of unit length.
  pure function facet_normal(facets, x, f) result(normal)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    integer, intent(in) :: f
    real(DP) :: normal(3), tangents(3, 2)
    call facet_tangents(facets, x, f, facet_centre(facets%kind(f)), tangents)
    normal = cross_product(tangents(:, 1), tangents(:, 2))
  end function facet_normal

end module amontons_self_contact_visibility
