!> Mortar constraint rows inv(D) M of a slave surface by dual shape functions.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, section 7. The integrals over a slave facet come from amontons_mortar_segmentation. With dual
!! functions phi_j (B. Wohlmuth, SIAM J. Numer. Anal. 38 (2000) 989-1012; amontons_dual_shape_functions) D is diagonal, and the rows
!! follow without the solution of equations:
!!
!!     d_j = x^_j - sum M_ji x_i / D_j,    D_j = integral of N~_j,    M_ji = integral of phi_j N_i (at the master)
module amontons_mortar
  use amontons_kinds, only: DP, PI
  use amontons_containers, only: list_groups
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: facet_kind, facet_kind_type, MAX_FACE_NODES
  use amontons_mesh, only: mesh_type
  use amontons_facets, only: facets_type, build_facets, facet_nodes, is_line_facet
  use amontons_tributary_areas, only: out_of_plane_depth
  use amontons_facet_search, only: facet_search_type, find_near_facets
  use amontons_polygon_clipping, only: signed_polygon_area, find_polygon_excess
  use amontons_dual_shape_functions, only: is_transformed, nodal_integral_fractions, BASIS_ALPHA
  use amontons_mortar_segmentation, only: projection_plane_type, mortar_segment_type, segmentation_type, build_segmentation, &
    build_projection_planes, project_on_plane, &
    project_facet_corners, find_depth, integrate_segments, keep_segmentation, is_facing_plane, is_unseen_facet
  use amontons_row_normals, only: normal_cone_type, find_row_normal
  use amontons_contact_constraint_rows, only: contact_row_type, evaluate_relative_position
  implicit none
  private
  public :: mortar_type, mortar_node_type, create_mortar, unify_imbalance_weights, add_pretension_rows, integrate_mortar, &
    mark_row_at_seam, build_rows, end_rows_at_edges, merge_rows, n_imbalance_nodes, vertices_of, &
    find_search_margin, find_mean_distance, rotate_with_normal, differentiate_rotation, fill_slave_part, redistribute_functions, &
    evaluate_transfer_slope

  real(DP), parameter :: MIN_COVERED_FRACTION = 1.0e-3_DP  !< a slave node has a row from this covered fraction of its area on [-]
  real(DP), parameter :: MIN_COUNTED_FRACTION = 1.0e-9_DP       !< with a smaller one it is not covered at all [-]
  real(DP), parameter :: MIN_COVER_RATIO = 0.5_DP  !< least covered fraction of a covered vertex over the best at its node [-]
  real(DP), parameter :: MAX_EXCESS = 0.1_DP  !< a slave node is over a master facet up to this fraction of an edge beyond it [-]
  real(DP), parameter :: MAX_EXCESS_LEAVING = 0.2_DP             !< the limit within an increment for a node that was over it [-]
  real(DP), parameter :: MAX_EXCESS_ENTERING = 0.0_DP          !< the limit within an increment for a node that was beside it [-]
  real(DP), parameter :: MAX_EXCESS_COMPLIANT = 0.2_DP  !< under a compliant law a node transfers a growing fraction of its
                                                        !! functions to others up to this limit [-]

  !> Position of a slave node relative to its master.
  type :: mortar_node_type
    integer :: facet = 0                           !< master facet with the largest part; 0: no facet in front
    integer :: vertex = 0                          !< vertex of the slave surface in contact
    logical :: is_barely_covered = .false.  !< the covered part is too small for a row of its own; it counts when rows are merged
    logical :: is_merged = .false.                 !< its row was merged into that of another pair
    logical :: is_shared = .false.                 !< its row contains that of another pair
    real(DP) :: whole = 0                          !< area of the node if all of it were covered [length^2]
    real(DP) :: xi(2) = 0                          !< centre of the node's part on that facet, natural coordinates [-]
    real(DP) :: area = 0                           !< D_j [length^2]
    real(DP) :: normal(3) = 0                      !< unit normal out of the master: opposite to that of the slave's cone
    real(DP) :: force_arm(3) = 0  !< from the node to the point of action of its force, if neighbouring nodes take part [length]
  end type mortar_node_type

  !> The segmentation of a whole slave surface, and its covered areas.
  type :: surface_segmentation_type
    integer, allocatable :: nodes(:)               !< of both surfaces, each once
    real(DP), allocatable :: x(:, :)               !< (3, size(nodes)) their coordinates at the segmentation [length]
    type(projection_plane_type), allocatable :: master_planes(:)   !< (master%n)
    type(segmentation_type), allocatable :: covers(:)     !< (n_facets)
    logical, allocatable :: is_current(:)          !< (n_facets) segmented at x
    logical, allocatable :: is_reference(:)        !< (n_facets) segmented at the coordinates of the last call without `is_apart`
    type(segmentation_type) :: work                !< of the current facet
    real(DP), allocatable :: area(:)               !< (n_vertices) covered area of a vertex [length^2]
    real(DP), allocatable :: whole(:)              !< (n_vertices) total area of a vertex [length^2]
  end type surface_segmentation_type

  !> The slave surface of a mortar pair with its rows.
  type :: mortar_type
    logical :: is_made = .false.                   !< the rows were integrated
    type(facets_type) :: slave
    integer, allocatable :: nodes(:)               !< (n) slave nodes
    type(mortar_node_type), allocatable :: places(:)     !< (n)
    type(contact_row_type), allocatable :: rows(:)      !< (n) in the current configuration
    type(contact_row_type), allocatable :: origin_rows(:)   !< (n) with respect to the origins
    real(DP), allocatable :: origin_normal(:, :)   !< (3, n) the normal at first touch
    real(DP), allocatable :: depth(:)              !< (n_facets) of slave lines: thickness [length], -1: the full circle; else 1
    integer, allocatable, private :: first(:)      !< (n + 1) start of a slave node's vertices in vertices(:)
    integer, allocatable, private :: vertices(:)
    integer, allocatable :: corners(:, :)          !< (2, n) the corners beside a mid-side node, else 0
    integer, allocatable :: corner_rows(:, :)             !< (2, n) their positions in nodes(:)
    logical, allocatable :: is_decoupled(:)  !< (n) no other row gives a force to the nodes whose imbalance forms that of the row
    logical :: has_unique_slaves = .true.                   !< its nodes are slaves of no other pair with exact contact
    logical, allocatable :: has_other_masters(:)   !< (n) slaves of other pairs, too, with a master there in this increment
    integer, allocatable :: node_pairs(:, :)            !< (2, n) rows of nodes, and of the nodes bound to them by an equation
    logical, allocatable :: is_at_seam(:)  !< (n) another pair has a coplanar master there, or may: the row continues
    logical, allocatable :: was_at_seam(:)  !< (n) another pair has one, at the last comparison of the increment
    logical, allocatable :: is_left_out(:)  !< (n) slaves of other pairs, too, beyond the master's edge: no row
    logical, allocatable :: was_closed(:)         !< (n) closed at the start of the increment
    real(DP), allocatable :: excess_limits(:)  !< (n) current excess limit up to which a node is over a master, over the edge [-]
    logical :: is_compliant = .false.                   !< its law is compliant
    real(DP), allocatable :: transferred_fraction(:)  !< (n) fraction that a node transfers to others: 0 over the master, 1 beyond
                                                      !! its edge [-]
    type(surface_segmentation_type) :: cuts                        !< the segmentation of which the rows are built
    integer, allocatable :: transfer_edges(:, :)   !< (4, n) of fractions between 0 and 1: slave facet, its node, master facet,
                                                   !! corner before its edge
    integer, allocatable :: row_of_entry(:)  !< (size(slave%nodes)) position in nodes(:) of each entry of the slave's facets
    type(contact_row_type), allocatable, private :: base_rows(:)   !< (n) own nodes and weights if no neighbour is beyond the master
  end type mortar_type

contains

  !> Sets up the facets of the slave surface, its nodes, and their data that do not depend on the configuration.
  subroutine create_mortar(mesh, element, face, nodes, mortar, error)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: element(:), face(:)     !< of the slave surface
    integer, intent(in) :: nodes(:)                !< all its nodes, each once
    type(mortar_type), intent(out) :: mortar
    type(error_type), allocatable, intent(out) :: error
    integer :: of_node(mesh%n_nodes), k, n
    call build_facets(mesh, element, face, mortar%slave, error)
    if (allocated(error)) return
    allocate (mortar%depth(mortar%slave%n), source=1.0_DP)
    do k = 1, mortar%slave%n
      if (is_line_facet(mortar%slave%kind(k))) mortar%depth(k) = out_of_plane_depth(mesh, element(k))
    end do
    n = size(nodes)
    mortar%nodes = nodes
    allocate (mortar%places(n), mortar%rows(n), mortar%origin_rows(n))
    allocate (mortar%was_closed(n), mortar%is_at_seam(n), mortar%was_at_seam(n), mortar%is_left_out(n), &
      mortar%has_other_masters(n), source=.false.)
    allocate (mortar%excess_limits(n), source=MAX_EXCESS)
    allocate (mortar%node_pairs(2, 0))
    of_node = 0
    of_node(nodes) = [(k, k=1, n)]
    mortar%row_of_entry = of_node(mortar%slave%nodes)
    call collect_vertices(mortar, of_node)
    call collect_imbalance_weights(mortar, of_node)
    mortar%origin_rows = mortar%rows
    allocate (mortar%origin_normal(3, n), source=0.0_DP)
    allocate (mortar%transfer_edges(4, n), source=0)
  end subroutine create_mortar


  !> Rotates a vector with a normal, about the axis perpendicular to both normals: R v with R n_0 = n.
  pure function rotate_with_normal(v, from, to) result(turned)
    real(DP), intent(in) :: v(3)
    real(DP), intent(in) :: from(3), to(3)         !< n_0 and n, unit vectors that are not opposite
    real(DP) :: turned(3), c
    c = dot_product(from, to)
    turned = v
    if (c <= -0.999_DP) return
    turned = v - dot_product(from + to, v) / (1 + c) * (from + to) + 2 * dot_product(from, v) * to
  end function rotate_with_normal


  !> The derivative of a vector rotated with a normal: d (R v)/d n.
  pure function differentiate_rotation(v, from, to) result(rate)
    real(DP), intent(in) :: v(3)
    real(DP), intent(in) :: from(3), to(3)         !< as `rotate_with_normal`
    real(DP) :: rate(3, 3), c, along
    integer :: k
    c = dot_product(from, to)
    rate = 0.0_DP
    if (c <= -0.999_DP) return
    along = dot_product(from + to, v) / (1 + c)
    do k = 1, 3
      rate(:, k) = (from + to) / (1 + c) * (along * from(k) - v(k))
      rate(k, k) = rate(k, k) + 2 * dot_product(from, v) - along
    end do
  end function differentiate_rotation


  !> The largest distance of master facets from the middle of a slave facet.
  pure real(DP) function find_search_margin(mortar, reach) result(margin)
    type(mortar_type), intent(in) :: mortar
    real(DP), intent(in) :: reach                  !< largest gap that matters [length]
    margin = reach + maxval(mortar%slave%edge_length)
  end function find_search_margin


  !> The vertices of each slave node: several on a crease of the slave surface.
  subroutine collect_vertices(mortar, of_node)
    type(mortar_type), intent(inout) :: mortar
    integer, intent(in) :: of_node(:)              !< (n_nodes) position among the slave nodes
    integer :: node_of(mortar%slave%n_vertices), k
    do k = 1, size(mortar%slave%nodes)
      node_of(mortar%slave%vertex(k)) = of_node(mortar%slave%nodes(k))
    end do
    call list_groups(node_of, size(mortar%nodes), mortar%first, mortar%vertices)
  end subroutine collect_vertices


  !> The vertices of the slave node of a row.
  pure function vertices_of(mortar, k) result(vertices)
    type(mortar_type), intent(in) :: mortar
    integer, intent(in) :: k                       !< row
    integer, allocatable :: vertices(:)
    vertices = mortar%vertices(mortar%first(k):mortar%first(k + 1) - 1)
  end function vertices_of


  !> The slave nodes whose imbalances form that of a row: with the transformed basis a corner has parts of the adjacent mid-sides.
  subroutine collect_imbalance_weights(mortar, of_node)
    type(mortar_type), intent(inout) :: mortar
    integer, intent(in) :: of_node(:)              !< (n_nodes) position among the slave nodes
    type(facet_kind_type) :: shape
    integer :: f, i, k, n, side, nodes(MAX_FACE_NODES), ends(2)
    allocate (mortar%corners(2, size(mortar%nodes)), mortar%corner_rows(2, size(mortar%nodes)), source=0)
    allocate (mortar%is_decoupled(size(mortar%nodes)), source=.false.)
    do k = 1, size(mortar%nodes)
      mortar%rows(k)%imbalance_nodes = [mortar%nodes(k)]
      mortar%rows(k)%imbalance_weights = [1.0_DP]
      mortar%rows(k)%nodes = [mortar%nodes(k)]
      mortar%rows(k)%weights = [1.0_DP]
    end do
    do f = 1, mortar%slave%n
      call facet_nodes(mortar%slave, f, n, nodes)
      shape = facet_kind(mortar%slave%kind(f))
      if (.not. is_transformed(mortar%slave%kind(f))) cycle
      do i = 1, n - shape%n_corners
        side = of_node(nodes(shape%n_corners + i))
        ends = of_node([nodes(i), nodes(modulo(i, shape%n_corners) + 1)])
        if (mortar%corners(1, side) > 0) cycle
        mortar%corners(:, side) = mortar%nodes(ends)
        mortar%corner_rows(:, side) = ends
        mortar%rows(side)%imbalance_weights = [1 - 2 * BASIS_ALPHA]
        do k = 1, 2
          mortar%rows(ends(k))%imbalance_nodes = [mortar%rows(ends(k))%imbalance_nodes, mortar%nodes(side)]
          mortar%rows(ends(k))%imbalance_weights = [mortar%rows(ends(k))%imbalance_weights, BASIS_ALPHA]
        end do
      end do
    end do
  end subroutine collect_imbalance_weights


  !> Slave surfaces that share nodes have one transformed basis: a corner has parts of the adjacent mid-sides on all of them.
  subroutine unify_imbalance_weights(mortars, n_nodes)
    type(mortar_type), intent(inout) :: mortars(:)
    integer, intent(in) :: n_nodes
    integer, allocatable :: midside_nodes(:, :)            ! (3, n) mid-side node and its corners
    integer, allocatable :: own(:)
    logical :: is_listed(n_nodes), is_shared(n_nodes)
    integer :: p, k, n
    is_listed = .false.
    allocate (midside_nodes(3, sum([(size(mortars(p)%nodes), p=1, size(mortars))])))
    n = 0
    do p = 1, size(mortars)
      do k = 1, size(mortars(p)%nodes)
        if (mortars(p)%corners(1, k) == 0 .or. is_listed(mortars(p)%nodes(k))) cycle
        is_listed(mortars(p)%nodes(k)) = .true.
        n = n + 1
        midside_nodes(:, n) = [mortars(p)%nodes(k), mortars(p)%corners(:, k)]
      end do
    end do
    is_listed = .false.
    is_shared = .false.
    do p = 1, size(mortars)
      where (is_listed(mortars(p)%nodes)) is_shared(mortars(p)%nodes) = .true.
      is_listed(mortars(p)%nodes) = .true.
    end do
    do p = 1, size(mortars)
      do k = 1, size(mortars(p)%nodes)
        associate (node => mortars(p)%nodes(k))
          if (.not. is_shared(node) .or. mortars(p)%corners(1, k) > 0) cycle
          own = pack(midside_nodes(1, :n), midside_nodes(2, :n) == node .or. midside_nodes(3, :n) == node)
          mortars(p)%rows(k)%imbalance_nodes = [node, own]
          mortars(p)%rows(k)%imbalance_weights = [1.0_DP, spread(BASIS_ALPHA, 1, size(own))]
        end associate
      end do
    end do
  end subroutine unify_imbalance_weights


  !> Adds to the imbalance of slave nodes to which others are bound, as across a pre-tension section, the parts of the mid-sides
  !! adjacent to those.
  subroutine add_pretension_rows(mortar, node_pairs)
    type(mortar_type), intent(inout) :: mortar
    integer, intent(in) :: node_pairs(:, :)             !< (2, n) nodes, and those bound to them
    integer :: k, at(2)
    do k = 1, size(node_pairs, 2)
      at = [findloc(mortar%nodes, node_pairs(1, k), dim=1), findloc(mortar%nodes, node_pairs(2, k), dim=1)]
      if (any(at == 0)) cycle
      mortar%node_pairs = reshape([mortar%node_pairs, at], [2, size(mortar%node_pairs, 2) + 1])
      mortar%rows(at(1))%imbalance_nodes = [mortar%rows(at(1))%imbalance_nodes, mortar%rows(at(2))%imbalance_nodes]
      mortar%rows(at(1))%imbalance_weights = [mortar%rows(at(1))%imbalance_weights, mortar%rows(at(2))%imbalance_weights]
    end do
  end subroutine add_pretension_rows


  !> Number of slave nodes at the head of a row.
  elemental integer function n_imbalance_nodes(mortar, k) result(n)
    type(mortar_type), intent(in) :: mortar
    integer, intent(in) :: k                       !< row
    n = merge(3, 1, mortar%corners(1, k) > 0)
  end function n_imbalance_nodes


  !> Merges two rows of the same slave node against masters side by side, or of slave surfaces side by side. The second row is
  !! removed.
  subroutine merge_rows(a, i, b, j)
    type(mortar_type), intent(inout) :: a, b       !< two pairs
    integer, intent(in) :: i, j                    !< rows of the same node, both with a master in front
    call average_rows(max(a%places(i)%whole, b%places(j)%whole), b%rows(j), a%places(i), a%rows(i), b%places(j))
  end subroutine merge_rows


  !> Merges the rows of two slave nodes that move together along the surface, as across a pre-tension section: the row of the sum of
  !! their functions. The equation that binds the second node transfers its force to the first. The second row is removed.
  subroutine merge_pretension_rows(mortar, i, j)
    type(mortar_type), intent(inout) :: mortar
    integer, intent(in) :: i, j                    !< rows of the free node and of the node bound to it
    real(DP) :: before, after                      ! fraction of the force at the head of the row
    type(mortar_node_type) :: mortar_node
    mortar_node = mortar%places(i)
    if (mortar%places(j)%vertex == 0) return
    if (mortar_node%vertex == 0) then
      mortar_node = mortar%places(j)
      mortar_node%area = 0.0_DP
      mortar_node%whole = 0.0_DP
    end if
    if (dot_product(mortar_node%normal, mortar%places(j)%normal) <= 0.0_DP) return
    before = merge(1 / (1 - 2 * BASIS_ALPHA), 1.0_DP, mortar%corners(1, i) > 0)
    call average_rows(mortar_node%whole + mortar%places(j)%whole, mortar%rows(j), mortar_node, mortar%rows(i), mortar%places(j))
    if (mortar%places(j)%is_merged) mortar%places(i) = mortar_node
    associate (row => mortar%rows(i))
      after = row%weights(1) + row%weights(findloc(row%nodes, mortar%nodes(j), dim=1))
      row%imbalance_weights = mortar%base_rows(i)%imbalance_weights * (before / after)
    end associate
  end subroutine merge_pretension_rows


  !> Means of two rows weighted by their areas; one area may be negative (as of transformed corner functions in places).
  pure subroutine average_rows(whole, other_row, mortar_node, row, other)
    real(DP), intent(in) :: whole                  !< total area of both [length^2]
    type(contact_row_type), intent(in) :: other_row
    type(mortar_node_type), intent(inout) :: mortar_node
    type(contact_row_type), intent(inout) :: row
    type(mortar_node_type), intent(inout) :: other       !< is_merged, unless the areas cancel
    real(DP) :: share
    integer :: k, at
    if (abs(mortar_node%area + other%area) <= MIN_COUNTED_FRACTION * whole) return
    share = other%area / (mortar_node%area + other%area)
    row%weights = (1 - share) * row%weights
    do k = 1, size(other_row%nodes)
      at = findloc(row%nodes, other_row%nodes(k), dim=1)
      if (at > 0) then
        row%weights(at) = row%weights(at) + share * other_row%weights(k)
      else
        row%nodes = [row%nodes, other_row%nodes(k)]
        row%weights = [row%weights, share * other_row%weights(k)]
      end if
    end do
    mortar_node%normal = (1 - share) * mortar_node%normal + share * other%normal
    mortar_node%normal = mortar_node%normal / norm2(mortar_node%normal)
    mortar_node%area = mortar_node%area + other%area
    mortar_node%whole = whole
    mortar_node%is_barely_covered = mortar_node%area <= MIN_COVERED_FRACTION * whole
    mortar_node%is_shared = .true.
    other = mortar_node_type(is_merged=.true.)
  end subroutine average_rows


  !> Integrates positions and rows of all slave nodes in a configuration. Facets whose nodes all stay open since the last call
  !! without `is_apart` keep its segmentation. Cost: linear in the number of segments.
  subroutine integrate_mortar(mortar, master, search, is_start, x, reach, is_apart)
    type(mortar_type), intent(inout) :: mortar
    type(facets_type), intent(in) :: master
    type(facet_search_type), intent(in) :: search        !< of the master's facets, with at least `find_search_margin`
    logical, intent(in) :: is_start  !< start of an increment: search and search distance may have changed since the last call
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates [length]
    real(DP), intent(in) :: reach                  !< larger distances between facets are ignored [length]
    logical, intent(in), optional :: is_apart(:)   !< (n) nodes that stay open since the last call without it
    if (.not. mortar%is_made) mortar%base_rows = mortar%rows
    if (is_start) mortar%is_at_seam = mortar%has_other_masters
    if (is_start) mortar%excess_limits = MAX_EXCESS
    call prepare_segmentation(mortar, master, is_start, x)
    call segment_facets(mortar, master, search, x, reach, is_apart)
    call build_rows(mortar, master, search, x, reach)
    mortar%is_made = .true.
  end subroutine integrate_mortar


  !> Marks the row of a slave node that is over another master and has a part of its faces over this one, but no row for it yet. The
  !! rows have to be built again.
  pure subroutine mark_row_at_seam(mortar, j, is_marked)
    type(mortar_type), intent(inout) :: mortar
    integer, intent(in) :: j                       !< its row
    logical, intent(inout) :: is_marked            !< out: .true. if it is
    if (.not. mortar%is_left_out(j) .or. mortar%is_at_seam(j)) return
    if (.not. any(mortar%cuts%area(mortar%vertices(mortar%first(j):mortar%first(j + 1) - 1)) > 0.0_DP)) return
    mortar%is_at_seam(j) = .true.
    is_marked = .true.
  end subroutine mark_row_at_seam


  !> Ends the rows of nodes that are slaves of several pairs at the master's edge, unless they were merged with those of a coplanar
  !! master in this increment, which continues there. The rows have to be built again.
  pure subroutine end_rows_at_edges(mortar, is_start)
    type(mortar_type), intent(inout) :: mortar     !< as integrated and merged
    logical, intent(in) :: is_start                !< start of an increment
    if (is_start) mortar%was_at_seam = .false.
    mortar%is_at_seam = mortar%was_at_seam .or. mortar%places%is_shared .or. mortar%places%is_merged
    mortar%was_at_seam = mortar%is_at_seam
    if (.not. is_start) return
    where (.not. mortar%is_at_seam) mortar%excess_limits = MAX_EXCESS
  end subroutine end_rows_at_edges


  !> The rows of all slave nodes from the segments of their facets.
  subroutine build_rows(mortar, master, search, x, reach)
    type(mortar_type), intent(inout) :: mortar
    type(facets_type), intent(in) :: master
    type(facet_search_type), intent(in) :: search
    real(DP), intent(in) :: x(:, :), reach
    integer :: f
    mortar%transferred_fraction = merge(0.0_DP, 1.0_DP, (mortar%was_closed .and. .not. mortar%is_compliant) .or. mortar%is_at_seam)
    do f = 1, mortar%slave%n
      call find_covered_nodes(mortar, f, master, search, x, reach)
    end do
    mortar%excess_limits = merge(MAX_EXCESS_LEAVING, MAX_EXCESS_ENTERING, mortar%transferred_fraction <= 0.0_DP)
    if (.not. mortar%is_compliant) call keep_isolated_facets(mortar)
    mortar%is_left_out = mortar%has_other_masters .and. mortar%transferred_fraction >= 1.0_DP .and. .not. mortar%is_compliant
    where (mortar%has_other_masters) mortar%transferred_fraction = 0.0_DP   ! other pairs act on them: no row takes their functions
    call fill_rows(mortar, master, x)
    call find_decoupled_rows(mortar)
    do f = 1, size(mortar%node_pairs, 2)
      call merge_pretension_rows(mortar, mortar%node_pairs(1, f), mortar%node_pairs(2, f))
    end do
  end subroutine build_rows


  !> Marks the rows that neither transfer functions to others nor receive any; the mid-side nodes of a corner count with it.
  pure subroutine find_decoupled_rows(mortar)
    type(mortar_type), intent(inout) :: mortar
    integer :: k
    do k = 1, size(mortar%nodes)
      mortar%is_decoupled(k) = mortar%places(k)%facet > 0 .and. mortar%transferred_fraction(k) <= 0.0_DP
      if (mortar%is_decoupled(k)) mortar%is_decoupled(k) &
        = .not. mortar%rows(k)%imbalance_weights(1) > mortar%base_rows(k)%imbalance_weights(1)
    end do
    do k = 1, size(mortar%nodes)
      if (mortar%corner_rows(1, k) > 0 .and. mortar%transferred_fraction(k) > 0.0_DP) mortar%is_decoupled(mortar%corner_rows(:, &
        k)) = .false.
    end do
  end subroutine find_decoupled_rows


  !> Coordinates and master planes of a segmentation. One at the same coordinates is kept, but for the start of an increment.
  subroutine prepare_segmentation(mortar, master, is_start, x)
    type(mortar_type), intent(inout) :: mortar
    type(facets_type), intent(in) :: master
    logical, intent(in) :: is_start                !< start of an increment
    real(DP), intent(in) :: x(:, :)
    logical :: is_used(size(x, 2)), is_same
    integer :: f
    is_same = allocated(mortar%cuts%x) .and. .not. is_start
    if (is_same) is_same = all(abs(mortar%cuts%x - x(:, mortar%cuts%nodes)) <= 0.0_DP)
    if (is_same) return
    if (.not. allocated(mortar%cuts%nodes)) then
      is_used = .false.
      is_used(mortar%slave%nodes) = .true.
      is_used(master%nodes) = .true.
      mortar%cuts%nodes = pack([(f, f=1, size(is_used))], is_used)
    end if
    mortar%cuts%x = x(:, mortar%cuts%nodes)
    if (.not. allocated(mortar%cuts%covers)) then
      allocate (mortar%cuts%covers(mortar%slave%n))
      allocate (mortar%cuts%is_current(mortar%slave%n), mortar%cuts%is_reference(mortar%slave%n), source=.false.)
      allocate (mortar%cuts%area(mortar%slave%n_vertices), mortar%cuts%whole(mortar%slave%n_vertices))
    end if
    mortar%cuts%master_planes = build_projection_planes(master, x)
    mortar%cuts%is_current = .false.
  end subroutine prepare_segmentation


  !> Segments all slave facets but those that stay apart from their masters, and sums the areas.
  subroutine segment_facets(mortar, master, search, x, reach, is_apart)
    type(mortar_type), intent(inout) :: mortar
    type(facets_type), intent(in) :: master
    type(facet_search_type), intent(in) :: search
    real(DP), intent(in) :: x(:, :), reach
    logical, intent(in), optional :: is_apart(:)   !< (n)
    integer :: f, k, n
    logical :: is_kept
    associate (cuts => mortar%cuts, slave => mortar%slave)
      cuts%area = 0.0_DP
      cuts%whole = 0.0_DP
      do f = 1, slave%n
        n = slave%first(f + 1) - slave%first(f)
        is_kept = cuts%is_current(f)
        if (present(is_apart) .and. .not. is_kept) is_kept = cuts%is_reference(f) .and. &
          all(is_apart(mortar%row_of_entry(slave%first(f):slave%first(f + 1) - 1)))
        if (.not. is_kept) then
          call segment_facet(slave, f, mortar%depth(f), master, search, x, reach, cuts)
          cuts%is_current(f) = .true.
          cuts%is_reference(f) = .false.
        end if
        associate (v => slave%vertex(slave%first(f):slave%first(f + 1) - 1), cover => cuts%covers(f))
          cuts%whole(v) = cuts%whole(v) + cover%area * facet_integral_fractions(slave%kind(f), n)
          do k = 1, cover%n
            cuts%area(v) = cuts%area(v) + cover%segments(k)%share(:n)
          end do
        end associate
      end do
      if (.not. present(is_apart)) cuts%is_reference = .true.
    end associate
  end subroutine segment_facets


  !> Segments one slave facet.
  subroutine segment_facet(slave, f, depth, master, search, x, reach, cuts)
    type(facets_type), intent(in) :: slave, master
    integer, intent(in) :: f                       !< slave facet
    real(DP), intent(in) :: depth                  !< of a line, as mortar%depth
    type(facet_search_type), intent(in) :: search
    real(DP), intent(in) :: x(:, :), reach
    type(surface_segmentation_type), intent(inout) :: cuts
    real(DP) :: corners(2, 4)
    integer :: n
    associate (work => cuts%work)
      call build_segmentation(slave, f, depth, master, cuts%master_planes, search, x, reach, work)
      call project_facet_corners(work%plane, slave, f, x, corners, n)
      work%area = signed_polygon_area(corners(:, :n)) * find_depth(work%plane, work%plane%origin)
      if (work%n > 0) call integrate_segments(slave, f, x, work%plane, work%area, work%points, work%segments(:work%n))
      call keep_segmentation(work, cuts%covers(f))
    end associate
  end subroutine segment_facet


  !> The derivative of the transferred fraction with respect to the distance beyond the edge, as a function of that fraction.
  elemental real(DP) function evaluate_transfer_slope(beyond) result(slope)
    real(DP), intent(in) :: beyond                 !< s^2 (3 - 2 s), s = distance/(MAX_EXCESS_COMPLIANT edge) [-]
    real(DP) :: s
    s = 0.5_DP - sin(asin(1 - 2 * min(max(beyond, 0.0_DP), 1.0_DP)) / 3)
    slope = 6 * s * (1 - s) / MAX_EXCESS_COMPLIANT
  end function evaluate_transfer_slope


  !> Marks the nodes of a slave facet with a master in front that are over the master. Exact contact: yes or no. Compliant law: a
  !! continuous fraction, so that forces are continuous. All master facets around count, not only those intersected by the slave
  !! facet, because the intersections can change while the node is near an edge.
  subroutine find_covered_nodes(mortar, f, master, search, x, reach)
    type(mortar_type), intent(inout) :: mortar
    integer, intent(in) :: f                       !< slave facet
    type(facets_type), intent(in) :: master
    type(facet_search_type), intent(in) :: search        !< of the master's facets
    real(DP), intent(in) :: x(:, :), reach
    integer, allocatable :: list(:)
    integer :: k, n
    associate (cover => mortar%cuts%covers(f), nodes => mortar%row_of_entry(mortar%slave%first(f):mortar%slave%first(f + 1) - 1))
      do k = 1, cover%n
        if (abs(sum(cover%segments(k)%share)) > 0.0_DP) call update_node_excess(mortar, f, master, cover%segments(k)%master, x)
      end do
      if (cover%n == 0 .or. all(mortar%transferred_fraction(nodes) <= 0.0_DP)) return
      call find_near_facets(search, cover%plane%origin, list, n)
      do k = 1, n
        if (any(cover%segments(:cover%n)%master == list(k))) cycle
        if (is_unseen_facet(mortar%slave, f, master, list(k))) cycle
        if (is_facing_plane(cover%plane, master, list(k), mortar%cuts%master_planes(list(k)), reach)) &
          call update_node_excess(mortar, f, master, list(k), x)
      end do
    end associate
  end subroutine find_covered_nodes


  !> Marks the nodes of a slave facet that are over one master facet.
  subroutine update_node_excess(mortar, f, master, g, x)
    type(mortar_type), intent(inout) :: mortar
    integer, intent(in) :: f, g                    !< slave and master facet
    type(facets_type), intent(in) :: master
    real(DP), intent(in) :: x(:, :)
    real(DP) :: corners(2, 4), distance, part
    integer :: i, j, m, n, edge, nodes(MAX_FACE_NODES)
    call facet_nodes(mortar%slave, f, n, nodes)
    associate (plane => mortar%cuts%covers(f)%plane)
      call project_facet_corners(plane, master, g, x, corners, m)
      do i = 1, n
        j = mortar%row_of_entry(mortar%slave%first(f) + i - 1)
        if (mortar%transferred_fraction(j) <= 0.0_DP) cycle
        call find_polygon_excess(corners(:, m:1:-1), project_on_plane(plane, x(:, nodes(i))), distance, edge)
        distance = distance / mortar%slave%edge_length(f)
        if (mortar%is_compliant) then
          part = min(max(distance / MAX_EXCESS_COMPLIANT, 0.0_DP), 1.0_DP)
          if (part**2 * (3 - 2 * part) >= mortar%transferred_fraction(j)) cycle
          mortar%transferred_fraction(j) = part**2 * (3 - 2 * part)
          mortar%transfer_edges(:, j) = [f, i, g, edge]
        else if (distance <= mortar%excess_limits(j)) then
          mortar%transferred_fraction(j) = 0.0_DP
        end if
      end do
    end associate
  end subroutine update_node_excess


  !> If no node of a facet with a master in front is over the master, all its nodes count as over it.
  pure subroutine keep_isolated_facets(mortar)
    type(mortar_type), intent(inout) :: mortar
    logical :: is_over(size(mortar%transferred_fraction))
    integer :: f
    is_over = mortar%transferred_fraction <= 0.0_DP
    do f = 1, mortar%slave%n
      if (mortar%cuts%covers(f)%n == 0) cycle
      associate (nodes => mortar%row_of_entry(mortar%slave%first(f):mortar%slave%first(f + 1) - 1))
        if (.not. any(is_over(nodes))) mortar%transferred_fraction(nodes) = 0.0_DP
      end associate
    end do
  end subroutine keep_isolated_facets


  !> Sets the first n fractions of a whole facet.
  pure function facet_integral_fractions(kind, n) result(share)
    integer, intent(in) :: kind, n
    real(DP) :: share(n), all_of(MAX_FACE_NODES)
    all_of = nodal_integral_fractions(kind)
    share = all_of(:n)
  end function facet_integral_fractions


  !> Builds positions and rows of all slave nodes from the segments of the facets around them.
  subroutine fill_rows(mortar, master, x)
    type(mortar_type), intent(inout) :: mortar
    type(facets_type), intent(in) :: master
    real(DP), intent(in) :: x(:, :)
    type(normal_cone_type) :: cone
    integer, allocatable :: at(:)                  ! (n_nodes) position in the current row, 0 outside
    real(DP) :: m(3)
    integer :: j, v
    allocate (at(size(x, 2)), source=0)
    do j = 1, size(mortar%nodes)
      associate (vertices => mortar%vertices(mortar%first(j):mortar%first(j + 1) - 1), mortar_node => mortar%places(j), &
        cuts => mortar%cuts)
        mortar_node = mortar_node_type()
        call fill_slave_part(mortar%nodes(j), mortar%corners(:, j), mortar%rows(j))
        mortar%rows(j)%imbalance_weights = mortar%base_rows(j)%imbalance_weights
        if (size(vertices) == 0 .or. mortar%is_left_out(j)) cycle
        v = choose_facing_vertex(mortar, vertices)
        if (abs(cuts%area(v)) <= MIN_COUNTED_FRACTION * cuts%whole(v)) cycle
        call find_row_normal(mortar%slave, vertices, v, cuts%covers, master, x, m, cone)
        if (norm2(m) <= 0.0_DP .or. (.not. mortar%is_compliant .and. mortar%transferred_fraction(j) >= 1.0_DP)) cycle
        mortar_node%vertex = v
        mortar_node%area = cuts%area(v)
        mortar_node%whole = cuts%whole(v)
        mortar_node%is_barely_covered = .not. mortar%is_compliant .and. mortar_node%area <= MIN_COVERED_FRACTION * mortar_node%whole
        mortar_node%normal = -m
        call fill_master_part(mortar, master, x, at, mortar_node, mortar%rows(j))
      end associate
    end do
  end subroutine fill_rows


  !> The vertex of a slave node in contact with the master. On a crease of the slave surface, as at the corner of a shank in its
  !! hole, it is the nearest of those covered nearly as well as the best. Selection by the area alone would alternate between faces
  !! that are covered alike.
  pure integer function choose_facing_vertex(mortar, vertices) result(v)
    type(mortar_type), intent(in) :: mortar
    integer, intent(in) :: vertices(:)             !< of one node
    real(DP) :: cover(size(vertices)), away(size(vertices))
    integer :: i
    associate (cuts => mortar%cuts)
      v = vertices(maxloc(cuts%area(vertices), dim=1))
      if (count(cuts%area(vertices) > MIN_COUNTED_FRACTION * cuts%whole(vertices)) < 2) return
      cover = cuts%area(vertices) / cuts%whole(vertices)
      away = [(find_mean_distance(mortar, vertices(i)), i=1, size(vertices))]
      v = vertices(minloc(away, dim=1, mask=cover >= MIN_COVER_RATIO * maxval(cover)))
    end associate
  end function choose_facing_vertex


  !> The mean distance of the facets around a vertex from their masters; 0 without any.
  pure real(DP) function find_mean_distance(mortar, v) result(distance)
    type(mortar_type), intent(in) :: mortar
    integer, intent(in) :: v                       !< vertex
    real(DP) :: area
    integer :: s, k
    distance = 0.0_DP
    area = 0.0_DP
    do s = mortar%slave%star_first(v), mortar%slave%star_first(v + 1) - 1
      associate (cover => mortar%cuts%covers(mortar%slave%star_facet(s)))
        do k = 1, cover%n
          distance = distance + sum(cover%segments(k)%share) * cover%segments(k)%distance
          area = area + sum(cover%segments(k)%share)
        end do
      end associate
    end do
    if (area > 0.0_DP) distance = distance / area
  end function find_mean_distance


  !> The slave's part of a row: x^_j.
  pure subroutine fill_slave_part(node, corners, row)
    integer, intent(in) :: node, corners(2)
    type(contact_row_type), intent(inout) :: row
    if (corners(1) == 0) then
      row%nodes = [node]
      row%weights = [1.0_DP]
    else
      row%nodes = [node, corners]
      row%weights = [1.0_DP, -BASIS_ALPHA, -BASIS_ALPHA] / (1 - 2 * BASIS_ALPHA)
    end if
  end subroutine fill_slave_part


  !> The master's part of a row: -M_ji / D_j, in the node order of the segments. Neighbouring nodes beyond the master's edge
  !! transfer their functions to the row: their part of the slave's side is included.
  subroutine fill_master_part(mortar, master, x, at, mortar_node, row)
    type(mortar_type), intent(in) :: mortar
    type(facets_type), intent(in) :: master
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    integer, intent(inout) :: at(:)                !< (n_nodes) 0 on entry and exit
    type(mortar_node_type), intent(inout) :: mortar_node
    type(contact_row_type), intent(inout) :: row
    real(DP), allocatable :: weights(:)
    integer, allocatable :: nodes(:)
    real(DP) :: largest, received(MAX_FACE_NODES), own_area, adjacent_area, first_moment(3), d_received(MAX_FACE_NODES, &
      MAX_FACE_NODES)
    integer :: s, k, n, f, own
    n = 0
    associate (slave => mortar%slave)
      do s = slave%star_first(mortar_node%vertex), slave%star_first(mortar_node%vertex + 1) - 1
        f = slave%star_facet(s)
        n = n + MAX_FACE_NODES * (mortar%cuts%covers(f)%n + 3)
      end do
      allocate (nodes(n))
      allocate (weights(n), source=0.0_DP)
      n = 0
      largest = -huge(1.0_DP)
      own_area = merge(0.0_DP, mortar_node%area, mortar%is_compliant)
      adjacent_area = 0.0_DP
      first_moment = 0.0_DP
      do s = slave%star_first(mortar_node%vertex), slave%star_first(mortar_node%vertex + 1) - 1
        f = slave%star_facet(s)
        own = slave%star_local(s)
        if (mortar%cuts%covers(f)%n == 0) cycle
        associate (segments => mortar%cuts%covers(f)%segments(:mortar%cuts%covers(f)%n))
          call redistribute_functions(slave%kind(f), own, &
            mortar%transferred_fraction(mortar%row_of_entry(slave%first(f):slave%first(f + 1) - 1)), received, d_received)
          if (mortar%is_compliant) own_area = own_area + received(own) * sum(segments%share(own))
          do k = 1, size(segments)
            call add_segment_weights(master, segments(k), received, at, n, nodes, weights)
            if (segments(k)%share(own) <= largest) cycle
            largest = segments(k)%share(own)
            mortar_node%facet = segments(k)%master
            mortar_node%xi = segments(k)%centre
          end do
          call add_adjacent_slave_nodes(mortar, f, own, received, segments)
        end associate
      end do
      at(nodes(:n)) = 0
    end associate
    mortar_node%area = own_area + adjacent_area
    if (abs(mortar_node%area) <= MIN_COUNTED_FRACTION * mortar_node%whole) then
      mortar_node = mortar_node_type()
      return
    end if
    if (adjacent_area > 0.0_DP) then
      first_moment = first_moment + own_area * evaluate_relative_position(row, x)
      row%weights = row%weights * (own_area / mortar_node%area)
      if (own_area > 0.0_DP) row%imbalance_weights = row%imbalance_weights * (mortar_node%area / own_area)
      mortar_node%force_arm = first_moment / mortar_node%area - x(:, row%nodes(1))
    end if
    call append_master_nodes(nodes(:n), -weights(:n) / mortar_node%area, row)

  contains

    !> Adds the neighbouring nodes that transfer their functions to the row, as nodes of the slave's side.
    subroutine add_adjacent_slave_nodes(mortar, f, own, received, segments)
      type(mortar_type), intent(in) :: mortar
      integer, intent(in) :: f, own                !< slave facet, local number of the row's node
      real(DP), intent(in) :: received(MAX_FACE_NODES)
      type(mortar_segment_type), intent(in) :: segments(:)
      type(contact_row_type) :: part
      real(DP) :: d
      integer :: i, q, j
      do i = 1, mortar%slave%first(f + 1) - mortar%slave%first(f)
        if (i == own .or. received(i) <= 0.0_DP) cycle
        d = received(i) * sum(segments%share(i))
        adjacent_area = adjacent_area + d
        j = mortar%row_of_entry(mortar%slave%first(f) + i - 1)
        call fill_slave_part(mortar%nodes(j), mortar%corners(:, j), part)
        first_moment = first_moment + d * evaluate_relative_position(part, x)
        do q = 1, size(part%nodes)
          call add_weight(part%nodes(q), -d * part%weights(q), at, n, nodes, weights)
        end do
      end do
    end subroutine add_adjacent_slave_nodes

  end subroutine fill_master_part


  !> Adds nodes and their weights to a row; a node that is in it already keeps its place.
  pure subroutine append_master_nodes(nodes, weights, row)
    integer, intent(in) :: nodes(:)                !< each once
    real(DP), intent(in) :: weights(:)             !< [-]
    type(contact_row_type), intent(inout) :: row
    logical :: is_new(size(nodes))
    integer :: i, k
    is_new = .true.
    do k = 1, size(row%nodes)
      i = findloc(nodes, row%nodes(k), dim=1)
      if (i == 0) cycle
      row%weights(k) = row%weights(k) + weights(i)
      is_new(i) = .false.
    end do
    row%nodes = [row%nodes, pack(nodes, is_new)]
    row%weights = [row%weights, pack(weights, is_new)]
  end subroutine append_master_nodes


  !> The fractions of the functions of a facet that one of its nodes receives: the part of its own that it keeps, and those of nodes
  !! beyond the master, which go to the nearest nodes over it. What the nearest cannot receive, being beyond as well, goes to nodes
  !! farther off; the remainder is kept.
  pure subroutine redistribute_functions(kind, own, beyond, received, d_received)
    integer, intent(in) :: kind                    !< FACET_...
    integer, intent(in) :: own                     !< local number of the node
    real(DP), intent(in) :: beyond(:)              !< (n) fraction transferred by each node [-]
    real(DP), intent(out) :: received(MAX_FACE_NODES) !< [-]
    real(DP), intent(out) :: d_received(MAX_FACE_NODES, MAX_FACE_NODES)  !< (i, k) derivative of received(i) with respect to
                                                                         !! beyond(k) [-]
    real(DP) :: at(2, MAX_FACE_NODES), distance(size(beyond)), rest, none, sum_of, d_rest(size(beyond)), d_none(size(beyond))
    logical :: is_near(size(beyond))
    integer :: i, j, k, n
    n = size(beyond)
    received = 0.0_DP
    d_received = 0.0_DP
    received(own) = 1 - beyond(own)
    d_received(own, own) = -1.0_DP
    if (all(beyond <= 0.0_DP)) return
    at = regular_node_positions(kind)
    do i = 1, n
      if (beyond(i) <= 0.0_DP) cycle
      distance = [(norm2(at(:, k) - at(:, i)), k=1, n)]
      distance(i) = huge(1.0_DP)
      rest = beyond(i)
      d_rest = [(merge(1.0_DP, 0.0_DP, k == i), k=1, n)]
      do while (any(distance < huge(1.0_DP)))
        is_near = distance < minval(distance) + 0.01_DP
        none = product(beyond, mask=is_near)
        d_none = [(product(beyond, mask=is_near .and. [(k /= j, j=1, n)]), k=1, n)]
        where (.not. is_near) d_none = 0.0_DP
        sum_of = sum(1 - beyond, mask=is_near)
        if (is_near(own) .and. none < 1.0_DP) then
          received(i) = rest * (1 - none) * (1 - beyond(own)) / sum_of
          d_received(i, :n) = (d_rest * (1 - none) - rest * d_none) * (1 - beyond(own)) / sum_of
          where (is_near) d_received(i, :n) = d_received(i, :n) + received(i) / sum_of
          d_received(i, own) = d_received(i, own) - rest * (1 - none) / sum_of
        end if
        d_rest = d_rest * none + rest * d_none
        rest = rest * none
        if (is_near(own)) exit
        where (is_near) distance = huge(1.0_DP)
      end do
      if (i == own) received(own) = received(own) + rest
      if (i == own) d_received(own, :n) = d_received(own, :n) + d_rest
    end do
  end subroutine redistribute_functions


  !> Positions of the nodes of a regular facet.
  pure function regular_node_positions(kind) result(at)
    integer, intent(in) :: kind                    !< FACET_...
    real(DP) :: at(2, MAX_FACE_NODES)              !< [-]
    type(facet_kind_type) :: shape
    integer :: i, m
    shape = facet_kind(kind)
    m = shape%n_corners
    at = 0.0_DP
    do i = 1, m
      at(:, i) = [cos(2 * PI * real(i, DP) / real(m, DP)), sin(2 * PI * real(i, DP) / real(m, DP))]
    end do
    do i = m + 1, shape%n_nodes
      at(:, i) = 0.5_DP * (at(:, i - m) + at(:, modulo(i - m, m) + 1))
    end do
  end function regular_node_positions


  !> Adds the contribution of one segment to M of a slave node.
  pure subroutine add_segment_weights(master, segment, received, at, n, nodes, weights)
    type(facets_type), intent(in) :: master
    type(mortar_segment_type), intent(in) :: segment
    real(DP), intent(in) :: received(MAX_FACE_NODES)  !< of the functions of the segment's slave facet [-]
    integer, intent(inout) :: at(:)                !< (n_nodes) position in nodes(:) or 0
    integer, intent(inout) :: n                    !< entries so far
    integer, intent(inout) :: nodes(:)
    real(DP), intent(inout) :: weights(:)          !< M_ji [length^2]
    integer :: own(MAX_FACE_NODES), i, n_own
    call facet_nodes(master, segment%master, n_own, own)
    do i = 1, n_own
      call add_weight(own(i), dot_product(received, segment%master_integrals(:, i)), at, n, nodes, weights)
    end do
  end subroutine add_segment_weights


  !> Adds to the weight of a node.
  pure subroutine add_weight(node, amount, at, n, nodes, weights)
    integer, intent(in) :: node
    real(DP), intent(in) :: amount                 !< [length^2]
    integer, intent(inout) :: at(:)                !< (n_nodes) position in nodes(:) or 0
    integer, intent(inout) :: n                    !< entries so far
    integer, intent(inout) :: nodes(:)
    real(DP), intent(inout) :: weights(:)          !< [length^2]
    if (at(node) == 0) then
      n = n + 1
      nodes(n) = node
      at(node) = n
    end if
    weights(at(node)) = weights(at(node)) + amount
  end subroutine add_weight

end module amontons_mortar
