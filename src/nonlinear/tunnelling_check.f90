!> Sliding distance of slave nodes within an increment, and tunnelling check: whether a node passed through its master.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_tunnelling_check
  use amontons_kinds, only: DP
  use amontons_model, only: model_type
  use amontons_slave_node_overrides, only: gives_way
  use amontons_state, only: slave_state_type, STATUS_OPEN
  use amontons_contact_constraint_rows, only: contact_row_type, fill_facet_row, evaluate_relative_position
  use amontons_analytic_master, only: evaluate_profile_bending
  use amontons_contact_pairs, only: contact_type, current_row, SEARCH_RADIUS_RATIO
  use amontons_mortar_segmentation, only: MIN_ROW_COSINE
  use amontons_facet_crossing, only: plane_normal, is_inside_facet
  use amontons_facets, only: facets_type, facet_nodes, is_line_facet, is_unseen
  use amontons_facet_search, only: facet_search_type, build_facet_search, find_near_facets
  use amontons_element_kinds, only: MAX_FACE_NODES, FACET_TRI3, FACET_TRI6
  implicit none
  private
  public :: largest_sliding, find_tunnelled_slave

  real(DP), parameter :: MIN_FRONT_DISTANCE = 1.0e-3_DP      !< least distance of a point in front of a facet, over its edge [-]

contains

  !> Largest sliding distance of the slave nodes for a change of displacement, in facets [-]. The length of a facet is its extent
  !! in the direction of sliding. On an analytic profile it is half the radius of curvature: a flat profile sets no limit.
  pure real(DP) function largest_sliding(contact, model, slaves, du) result(largest)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slaves(:)
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) [length]
    type(contact_row_type) :: row
    real(DP) :: d(3)
    integer :: s
    largest = 0.0_DP
    do s = 1, size(slaves)
      associate (slave => slaves(s))
        if (slave%facet == 0 .or. contact%has_fixed_geometry(slave%pair)) cycle
        call current_row(contact, slave, row)
        d = evaluate_relative_position(row, du)
        d = d - dot_product(slave%normal, d) * slave%normal
        if (norm2(d) <= 0.0_DP) cycle
        associate (facets => contact%facets(slave%pair))
          if (allocated(facets%profile)) then
            largest = max(largest, norm2(d) * evaluate_profile_bending(facets, slave%facet, slave%xi))
            cycle
          end if
          largest = max(largest, norm2(d) / facet_width(model%mesh%coordinates(:, facets%nodes(facets%first(slave%facet): &
            facets%first(slave%facet + 1) - 1)), d / norm2(d), facets%edge_length(slave%facet)))
        end associate
      end associate
    end do
  end function largest_sliding


  !> Extent of points along a direction; `fallback_length` where it vanishes [length].
  pure real(DP) function facet_width(points, direction, fallback_length) result(width)
    real(DP), intent(in) :: points(:, :)           !< (3, :) [length]
    real(DP), intent(in) :: direction(3), fallback_length
    real(DP) :: along(size(points, 2))
    along = matmul(direction, points)
    width = maxval(along) - minval(along)
    if (width <= 1.0e-6_DP * fallback_length) width = fallback_length
  end function facet_width


  !> Finds the first slave that passed through its master within the increment; 0: none. Two criteria:
  !!
  !! - The node had a projection and has none now, and lies behind its old projection point by more than the search depth. (A
  !!   path over the master's edge counts too: only its ends are known.)
  !! - The node is open, with no projection, or on the opposite side of the master, or without projection before, and its straight
  !!   path crosses a facet from the front. Sliding over the master's edge is excluded by the least steepness. A row of
  !!   surface-to-surface contact holds in the mean over the slave's faces: its node may lie behind facets that the row faces,
  !!   within the search depth. Only what the row does not face can have been crossed.
  integer function find_tunnelled_slave(contact, x_old, x_new, old, new, min_steepness) result(tunnelled)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x_old(:, :), x_new(:, :)   !< (3, n_nodes) at the start and at the end of the increment [length]
    type(slave_state_type), intent(in) :: old(:)         !< (n_slaves) at the start of the increment
    type(slave_state_type), intent(in) :: new(:)         !< (n_slaves) at its end
    real(DP), intent(in) :: min_steepness          !< min_crossing_steepness of the controls [-]
    type(contact_row_type) :: row
    type(facet_search_type) :: search(size(contact%facets))
    integer :: s
    do tunnelled = 1, size(new)
      s = tunnelled
      if (contact%is_removed(new(s)%pair)) cycle
      if (gives_way(new(s)%overrides)) cycle       ! checked by the other side of a symmetric pair
      if (old(s)%facet > 0 .and. new(s)%facet == 0) then
        call fill_facet_row(contact%facets(old(s)%pair), old(s)%facet, old(s)%xi, old(s)%node, row)
        if (dot_product(old(s)%normal, evaluate_relative_position(row, &
          x_new)) < -SEARCH_RADIUS_RATIO * contact%edge(old(s)%pair)) return
      end if
      if (contact%has_fixed_geometry(new(s)%pair) .or. .not. may_have_crossed(old(s), new(s))) cycle
      associate (facets => contact%facets(new(s)%pair), near => search(new(s)%pair))
        if (allocated(facets%profile)) cycle       ! an analytic profile has no meshed facets to cross
        if (.not. allocated(near%first)) call build_facet_search(facets, x_new, &
          crossing_reach(facets, pack(new%node, new%pair == new(s)%pair), x_old, x_new), near)
        if (has_crossed_master(facets, near, x_old, x_new, new(s), min_steepness)) return
      end associate
    end do
    tunnelled = 0
  end function find_tunnelled_slave


  !> Largest distance between a facet and a node that crossed it [length]: the displacements of both relative to the mean motion of
  !! the facets, plus the warp of the facets (distance of corners from the mean plane).
  pure real(DP) function crossing_reach(facets, nodes, x_old, x_new) result(largest)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: nodes(:)                !< slave nodes
    real(DP), intent(in) :: x_old(:, :), x_new(:, :)   !< (3, n_nodes) [length]
    real(DP) :: mean(3), warp
    integer :: f
    mean = sum(x_new(:, facets%nodes) - x_old(:, facets%nodes), dim=2) / real(size(facets%nodes), DP)
    warp = 0.0_DP
    do f = 1, facets%n
      if (n_corners(facets%kind(f)) < 4) cycle
      associate (corner => x_new(:, facets%nodes(facets%first(f):facets%first(f) + 3)))
        warp = max(warp, norm2(corner(:, 1) - corner(:, 2) + corner(:, 3) - corner(:, 4)) / 4)
      end associate
    end do
    largest = warp + longest_displacement(facets%nodes) + longest_displacement(nodes)

  contains

    !> Largest displacement of some nodes relative to the mean one [length].
    pure real(DP) function longest_displacement(nodes_of_set) result(longest)
      integer, intent(in) :: nodes_of_set(:)
      integer :: i
      longest = 0.0_DP
      do i = 1, size(nodes_of_set)
        longest = max(longest, norm2(x_new(:, nodes_of_set(i)) - x_old(:, nodes_of_set(i)) - mean))
      end do
    end function longest_displacement

  end function crossing_reach


  !> Whether a node may have passed through its master: it is open, and not known to be on the same side as before.
  pure logical function may_have_crossed(old, new)
    type(slave_state_type), intent(in) :: old, new
    may_have_crossed = new%status == STATUS_OPEN
    if (old%facet > 0 .and. new%facet > 0) may_have_crossed = may_have_crossed .and. dot_product(old%normal, new%normal) < 0.0_DP
  end function may_have_crossed


  !> Whether the straight path of a point crosses a facet from front to back; the facet moves with its centre.
  logical function has_crossed_master(facets, search, x_old, x_new, slave, min_steepness)
    type(facets_type), intent(in) :: facets
    type(facet_search_type), intent(in) :: search        !< at x_new, with the margin `crossing_reach`
    real(DP), intent(in) :: x_old(:, :), x_new(:, :)   !< (3, n_nodes) coordinates [length]
    type(slave_state_type), intent(in) :: slave    !< of the point, at the end
    real(DP), intent(in) :: min_steepness          !< of a path that counts wherever it ends [-]
    integer, allocatable :: list(:)
    integer :: i, n
    real(DP) :: steepness, facing(3)
    call find_near_facets(search, x_new(:, slave%node), list, n)
    facing = 0.0_DP
    if (slave%row > 0 .and. slave%facet > 0) facing = slave%normal
    has_crossed_master = .false.
    do i = 1, n
      if (is_unseen(facets, slave%node, list(i))) cycle
      steepness = crossing_steepness(facets, list(i), x_old, x_new, slave%node, facing)
      if (steepness <= 0.0_DP) cycle
      if (steepness < min_steepness .and. .not. projects_on_facets(facets, list(:n), x_new, slave%node)) cycle
      has_crossed_master = .true.
      return
    end do
  end function has_crossed_master


  !> The same for one facet: normal part of the path over its length [-]; 0 where the path does not cross the mean plane of the
  !! corners within the facet, or ends behind it by no more than the facet's curvature or warp, or by no more than the search
  !! depth where the point's row faces the facet.
  pure real(DP) function crossing_steepness(facets, f, x_old, x_new, node, facing) result(steepness)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f
    real(DP), intent(in) :: x_old(:, :), x_new(:, :)
    integer, intent(in) :: node
    real(DP), intent(in) :: facing(3)              !< normal of the master in the point's row; 0: no row [-]
    real(DP) :: start(3), path(3), normal(3), centre(3), before, behind, corner(3, 4)
    integer :: n, m, nodes(MAX_FACE_NODES)
    steepness = 0.0_DP
    call facet_nodes(facets, f, n, nodes)
    m = n_corners(facets%kind(f))
    corner(:, :m) = x_new(:, nodes(:m))
    centre = sum(corner(:, :m), dim=2) / real(m, DP)
    start = x_old(:, node) + centre - sum(x_old(:, nodes(:m)), dim=2) / real(m, DP)
    path = x_new(:, node) - start
    if (norm2(start - centre) > norm2(path) + 2.0_DP * facets%edge_length(f)) return   ! out of reach
    normal = plane_normal(corner(:, :m), is_line_facet(facets%kind(f)))
    if (norm2(normal) <= 0.0_DP) return
    before = dot_product(normal, start - centre)
    behind = -dot_product(normal, x_new(:, node) - centre)
    if (before <= MIN_FRONT_DISTANCE * facets%edge_length(f)) return
    if (behind <= maxval(abs(matmul(normal, x_new(:, nodes(:n)) - spread(centre, 2, n))))) return
    if (dot_product(normal, facing) > MIN_ROW_COSINE .and. behind <= SEARCH_RADIUS_RATIO * facets%edge_length(f)) return
    if (is_inside_facet(start + before / (before + behind) * path, corner(:, :m), normal, is_line_facet(facets%kind(f)))) &
      steepness = (before + behind) / norm2(path)
  end function crossing_steepness


  !> Whether a point projects along the normal on one of some facets.
  pure logical function projects_on_facets(facets, list, x, node)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: list(:)
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    integer, intent(in) :: node                    !< the point
    real(DP) :: corner(3, 4)
    integer :: i, m, n, nodes(MAX_FACE_NODES)
    projects_on_facets = .false.
    do i = 1, size(list)
      call facet_nodes(facets, list(i), n, nodes)
      m = n_corners(facets%kind(list(i)))
      corner(:, :m) = x(:, nodes(:m))
      projects_on_facets = is_inside_facet(x(:, node), corner(:, :m), plane_normal(corner(:, :m), &
        is_line_facet(facets%kind(list(i)))), &
        is_line_facet(facets%kind(list(i))))
      if (projects_on_facets) return
    end do
  end function projects_on_facets


  !> Number of corners of a facet.
  pure integer function n_corners(kind)
    integer, intent(in) :: kind                    !< FACET_...
    n_corners = 4
    if (kind == FACET_TRI3 .or. kind == FACET_TRI6) n_corners = 3
    if (is_line_facet(kind)) n_corners = 2
  end function n_corners

end module amontons_tunnelling_check
