!> Mortar: the rows of a slave surface from integrals over the parts of its faces that face the master: inv(D) M.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, "Mortar". The integrals over a slave facet come from `segments`. With dual functions phi_j
!! (B. Wohlmuth, SIAM J. Numer. Anal. 38 (2000) 989-1012; `dual`) D is diagonal and a row needs no equations to be solved:
!!
!!     d_j = x^_j - sum M_ji x_i / D_j,    D_j = integral of N~_j,    M_ji = integral of phi_j N_i (at the master)
module amontons_mortar
  use amontons_kinds, only: DP, PI
  use amontons_errors, only: error_type
  use amontons_topology, only: facet_kind, facet_kind_type, MAX_FACE_NODES
  use amontons_mesh, only: mesh_type
  use amontons_facets, only: facets_type, build_facets, facet_nodes, is_line_facet
  use amontons_tributary_areas, only: out_of_plane_depth
  use amontons_facet_search, only: facet_search_type, find_near_facets
  use amontons_surface_projection, only: evaluate_vertex_normal
  use amontons_polygon_clipping, only: signed_polygon_area, find_polygon_excess
  use amontons_dual_shape_functions, only: is_transformed, nodal_integral_fractions, BASIS_ALPHA
  use amontons_mortar_segmentation, only: mortar_segment_type, segmentation_type, build_segmentation, project_on_plane, &
    project_facet_corners, find_depth, &
    integrate_segments, is_facing_plane
  use amontons_contact_constraint_rows, only: contact_row_type, evaluate_relative_position
  implicit none
  private
  public :: mortar_type, mortar_node_type, create_mortar, unify_imbalance_weights, add_pretension_rows, integrate_mortar, &
    merge_rows, n_imbalance_nodes, &
    find_search_margin, rotate_with_normal, differentiate_rotation, fill_slave_part, redistribute_functions, evaluate_transfer_slope

  real(DP), parameter :: MIN_COVERED_FRACTION = 1.0e-3_DP       !< a slave node with less of its area in front of the master has no
                                                                !! row [-]
  real(DP), parameter :: MIN_COUNTED_FRACTION = 1.0e-9_DP       !< with less than this it does not count at all [-]
  real(DP), parameter :: MIN_COVER_RATIO = 0.5_DP            !< of the best cover of the vertices of a node: another is covered
                                                             !! like it [-]
  real(DP), parameter :: MAX_EXCESS = 0.1_DP           !< a slave node is over a master facet up to this part of an edge beyond it
                                                       !! [-]
  real(DP), parameter :: MAX_EXCESS_LEAVING = 0.2_DP             !< in an increment one that is over it, up to this part [-]
  real(DP), parameter :: MAX_EXCESS_ENTERING = 0.0_DP          !< and one that is beside it, from there on [-]
  real(DP), parameter :: MAX_EXCESS_COMPLIANT = 0.2_DP            !< under a compliant law its part goes over to others up to this
                                                                  !! one [-]

  !> Where a slave node is against its master.
  type :: mortar_node_type
    integer :: facet = 0                           !< master facet that takes the largest part; 0: nothing is in front
    integer :: vertex = 0                          !< vertex of the slave surface whose facets touch
    logical :: is_barely_covered = .false.                   !< so little is in front that the node has no row; it counts where
                                                             !! rows merge
    logical :: is_merged = .false.                 !< the row went into that of another pair
    logical :: is_shared = .false.                 !< the row has that of another pair in it
    real(DP) :: whole = 0                          !< area of the node if all of it were covered [length^2]
    real(DP) :: xi(2) = 0                          !< middle of what the node has on that facet, natural coordinates [-]
    real(DP) :: area = 0                           !< D_j [length^2]
    real(DP) :: normal(3) = 0                      !< unit normal, out of the master: that of the slave's vertex turned round
    real(DP) :: force_arm(3) = 0                         !< from the node to where its force acts, if nodes beside it have part
                                                         !! [length]
  end type mortar_node_type

  !> The cuts of a whole slave surface, and what is covered of it.
  type :: surface_segmentation_type
    integer, allocatable :: nodes(:)               !< of both surfaces, each once
    real(DP), allocatable :: x(:, :)               !< (3, size(nodes)) their coordinates where the cuts were made [length]
    type(segmentation_type), allocatable :: covers(:)     !< (n_facets)
    real(DP), allocatable :: area(:)               !< (n_vertices) what is covered of a vertex [length^2]
    real(DP), allocatable :: whole(:)              !< (n_vertices) all of it [length^2]
  end type surface_segmentation_type

  !> The slave surface of a pair with its rows.
  type :: mortar_type
    logical :: is_made = .false.                   !< the rows were integrated
    type(facets_type) :: slave
    integer, allocatable :: nodes(:)               !< (n) slave nodes
    type(mortar_node_type), allocatable :: places(:)     !< (n)
    type(contact_row_type), allocatable :: rows(:)      !< (n) as they touch now
    type(contact_row_type), allocatable :: origin_rows(:)   !< (n) against their origins
    real(DP), allocatable :: origin_normal(:, :)   !< (3, n) the normal when they touched there
    real(DP), allocatable :: depth(:)              !< (n_facets) of slave lines: thickness [length], -1: the full circle; else 1
    integer, allocatable, private :: first(:)      !< (n + 1) start of a slave node's vertices in vertices(:)
    integer, allocatable, private :: vertices(:)
    integer, allocatable :: corners(:, :)          !< (2, n) the corners beside a mid-side node, else 0
    integer, allocatable :: corner_rows(:, :)             !< (2, n) their places among the slave nodes
    logical, allocatable :: is_decoupled(:)            !< (n) no other row has a force on the nodes whose imbalance is the row's
    logical :: has_unique_slaves = .true.                   !< its nodes are slaves of no other exact pair
    integer, allocatable :: twins(:, :)            !< (2, n) rows of nodes, and of those that are bound to them by an equation
    logical, allocatable :: was_closed(:)         !< (n) closed when the increment began
    real(DP), allocatable :: excess_limits(:)            !< (n) part of an edge beyond a master up to which a node is over it now
                                                         !! [-]
    logical :: is_compliant = .false.                   !< its law is compliant
    real(DP), allocatable :: transferred_fraction(:)             !< (n) what a node gives to others: 0 over the master, 1 beyond
                                                                 !! its edge [-]
    type(surface_segmentation_type) :: cuts                        !< of which the rows are made
    integer, allocatable :: transfer_edges(:, :)            !< (4, n) where that is so in part: slave facet, its node, master
                                                            !! facet, corner
                                                   !< before its edge
    integer, allocatable :: row_of_entry(:)            !< (size(slave%nodes)) place in nodes(:) of each entry of the slave's facets
    type(contact_row_type), allocatable, private :: base_rows(:)   !< (n) own nodes and shares where no node beside is beyond the
                                                                   !! master
  end type mortar_type

contains

  !> Facets of the slave surface, its nodes, and what belongs to each of them whatever the configuration.
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
    allocate (mortar%was_closed(n), source=.false.)
    allocate (mortar%excess_limits(n), source=MAX_EXCESS)
    allocate (mortar%twins(2, 0))
    of_node = 0
    of_node(nodes) = [(k, k=1, n)]
    mortar%row_of_entry = of_node(mortar%slave%nodes)
    call collect_vertices(mortar, of_node)
    call collect_imbalance_weights(mortar, of_node)
    mortar%origin_rows = mortar%rows
    allocate (mortar%origin_normal(3, n), source=0.0_DP)
    allocate (mortar%transfer_edges(4, n), source=0)
  end subroutine create_mortar


  !> A vector turned as a normal turned, about the axis that is normal to both: R v with R n_0 = n.
  pure function rotate_with_normal(v, from, to) result(turned)
    real(DP), intent(in) :: v(3)
    real(DP), intent(in) :: from(3), to(3)         !< n_0 and n, unit vectors that are not opposite
    real(DP) :: turned(3), c
    c = dot_product(from, to)
    turned = v
    if (c <= -0.999_DP) return
    turned = v - dot_product(from + to, v) / (1 + c) * (from + to) + 2 * dot_product(from, v) * to
  end function rotate_with_normal


  !> How a vector that turns with a normal changes with it: d (R v)/d n.
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


  !> How far from the middle of a slave facet its master facets may be.
  pure real(DP) function find_search_margin(mortar, reach) result(margin)
    type(mortar_type), intent(in) :: mortar
    real(DP), intent(in) :: reach                  !< largest gap that matters [length]
    margin = reach + maxval(mortar%slave%edge_length)
  end function find_search_margin


  !> The vertices of each slave node: more than one on a crease of the slave surface.
  subroutine collect_vertices(mortar, of_node)
    type(mortar_type), intent(inout) :: mortar
    integer, intent(in) :: of_node(:)              !< (n_nodes) place among the slave nodes
    integer :: node_of(mortar%slave%n_vertices), k, v, n
    integer, allocatable :: next(:)
    do k = 1, size(mortar%slave%nodes)
      node_of(mortar%slave%vertex(k)) = of_node(mortar%slave%nodes(k))
    end do
    n = size(mortar%nodes)
    allocate (mortar%first(n + 1), source=0)
    allocate (mortar%vertices(size(node_of)))
    do v = 1, size(node_of)
      mortar%first(node_of(v) + 1) = mortar%first(node_of(v) + 1) + 1
    end do
    mortar%first(1) = 1
    do k = 1, n
      mortar%first(k + 1) = mortar%first(k + 1) + mortar%first(k)
    end do
    next = mortar%first
    do v = 1, size(node_of)
      mortar%vertices(next(node_of(v))) = v
      next(node_of(v)) = next(node_of(v)) + 1
    end do
  end subroutine collect_vertices


  !> The slave nodes whose imbalance makes that of a row: with the transformed basis a corner has shares of the mid-sides beside it.
  subroutine collect_imbalance_weights(mortar, of_node)
    type(mortar_type), intent(inout) :: mortar
    integer, intent(in) :: of_node(:)              !< (n_nodes) place among the slave nodes
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


  !> Slave surfaces that share nodes have one transformed basis: a corner has shares of the mid-sides beside it on all of them.
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


  !> Slave nodes to which others are bound, as across a pre-tension section, have a share of what the mid-sides beside those carry,
  !! too.
  subroutine add_pretension_rows(mortar, twins)
    type(mortar_type), intent(inout) :: mortar
    integer, intent(in) :: twins(:, :)             !< (2, n) nodes, and those bound to them
    integer :: k, at(2)
    do k = 1, size(twins, 2)
      at = [findloc(mortar%nodes, twins(1, k), dim=1), findloc(mortar%nodes, twins(2, k), dim=1)]
      if (any(at == 0)) cycle
      mortar%twins = reshape([mortar%twins, at], [2, size(mortar%twins, 2) + 1])
      mortar%rows(at(1))%imbalance_nodes = [mortar%rows(at(1))%imbalance_nodes, mortar%rows(at(2))%imbalance_nodes]
      mortar%rows(at(1))%imbalance_weights = [mortar%rows(at(1))%imbalance_weights, mortar%rows(at(2))%imbalance_weights]
    end do
  end subroutine add_pretension_rows


  !> Nodes of the slave side at the head of a row.
  elemental integer function n_imbalance_nodes(mortar, k) result(n)
    type(mortar_type), intent(in) :: mortar
    integer, intent(in) :: k                       !< row
    n = merge(3, 1, mortar%corners(1, k) > 0)
  end function n_imbalance_nodes


  !> One row in place of two of the same slave node against masters that lie side by side, or of slave surfaces that do. The second
  !! row is gone.
  subroutine merge_rows(a, i, b, j)
    type(mortar_type), intent(inout) :: a, b       !< two pairs
    integer, intent(in) :: i, j                    !< rows of the same node, both with a master in front
    call average_rows(max(a%places(i)%whole, b%places(j)%whole), b%rows(j), a%places(i), a%rows(i), b%places(j))
  end subroutine merge_rows


  !> One row in place of those of two slave nodes that go along the surface together, as across a pre-tension section: that of the
  !! sum of their functions. What comes on the second node is on the first by the equation that binds them. The second row is gone.
  subroutine merge_pretension_rows(mortar, i, j)
    type(mortar_type), intent(inout) :: mortar
    integer, intent(in) :: i, j                    !< rows of the node that is free, and of the one that is bound to it
    real(DP) :: before, after                      ! what the head of the row takes of its force
    type(mortar_node_type) :: place
    place = mortar%places(i)
    if (mortar%places(j)%vertex == 0) return
    if (place%vertex == 0) then
      place = mortar%places(j)
      place%area = 0.0_DP
      place%whole = 0.0_DP
    end if
    if (dot_product(place%normal, mortar%places(j)%normal) <= 0.0_DP) return
    before = merge(1 / (1 - 2 * BASIS_ALPHA), 1.0_DP, mortar%corners(1, i) > 0)
    call average_rows(place%whole + mortar%places(j)%whole, mortar%rows(j), place, mortar%rows(i), mortar%places(j))
    if (mortar%places(j)%is_merged) mortar%places(i) = place
    associate (row => mortar%rows(i))
      after = row%weights(1) + row%weights(findloc(row%nodes, mortar%nodes(j), dim=1))
      row%imbalance_weights = mortar%base_rows(i)%imbalance_weights * (before / after)
    end associate
  end subroutine merge_pretension_rows


  !> The means of two rows by their areas, of which one may be negative (the transformed functions of corners are so in places).
  pure subroutine average_rows(whole, other_row, place, row, other)
    real(DP), intent(in) :: whole                  !< area of both if all were covered [length^2]
    type(contact_row_type), intent(in) :: other_row
    type(mortar_node_type), intent(inout) :: place
    type(contact_row_type), intent(inout) :: row
    type(mortar_node_type), intent(inout) :: other       !< is_merged, unless the areas cancel
    real(DP) :: share
    integer :: k, at
    if (abs(place%area + other%area) <= MIN_COUNTED_FRACTION * whole) return
    share = other%area / (place%area + other%area)
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
    place%normal = (1 - share) * place%normal + share * other%normal
    place%normal = place%normal / norm2(place%normal)
    place%area = place%area + other%area
    place%whole = whole
    place%is_barely_covered = place%area <= MIN_COVERED_FRACTION * whole
    place%is_shared = .true.
    other = mortar_node_type(is_merged=.true.)
  end subroutine average_rows


  !> Places and rows of all slave nodes in a configuration. Cost: linear in the segments.
  subroutine integrate_mortar(mortar, master, search, is_start, x, reach)
    type(mortar_type), intent(inout) :: mortar
    type(facets_type), intent(in) :: master
    type(facet_search_type), intent(in) :: search        !< of the master's facets, with at least `find_search_margin`
    logical, intent(in) :: is_start                !< an increment begins: the search and the reach are not those of the last call
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates [length]
    real(DP), intent(in) :: reach                  !< facets farther apart do not see each other [length]
    logical :: is_cut
    integer :: f
    if (.not. mortar%is_made) mortar%base_rows = mortar%rows
    if (is_start) mortar%excess_limits = MAX_EXCESS
    is_cut = allocated(mortar%cuts%x) .and. .not. is_start
    if (is_cut) is_cut = all(abs(mortar%cuts%x - x(:, mortar%cuts%nodes)) <= 0.0_DP)
    if (.not. is_cut) call segment_facets(mortar, master, search, x, reach)
    mortar%transferred_fraction = merge(0.0_DP, 1.0_DP, (mortar%was_closed .and. .not. mortar%is_compliant) &
      .or. .not. mortar%has_unique_slaves)
    do f = 1, mortar%slave%n
      call find_covered_nodes(mortar, f, master, search, x, reach)
    end do
    mortar%excess_limits = merge(MAX_EXCESS_LEAVING, MAX_EXCESS_ENTERING, mortar%transferred_fraction <= 0.0_DP)
    if (.not. mortar%is_compliant) call keep_isolated_facets(mortar)
    call fill_rows(mortar, master, x)
    call find_decoupled_rows(mortar)
    do f = 1, size(mortar%twins, 2)
      call merge_pretension_rows(mortar, mortar%twins(1, f), mortar%twins(2, f))
    end do
    mortar%is_made = .true.
  end subroutine integrate_mortar


  !> Which rows neither give a part of their functions to others nor take one; the mid-side nodes of a corner count with it.
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


  !> The cuts of all slave facets.
  subroutine segment_facets(mortar, master, search, x, reach)
    type(mortar_type), intent(inout) :: mortar
    type(facets_type), intent(in) :: master
    type(facet_search_type), intent(in) :: search
    real(DP), intent(in) :: x(:, :), reach
    logical :: is_used(size(x, 2))
    integer :: f
    if (.not. allocated(mortar%cuts%nodes)) then
      is_used = .false.
      is_used(mortar%slave%nodes) = .true.
      is_used(master%nodes) = .true.
      mortar%cuts%nodes = pack([(f, f=1, size(is_used))], is_used)
    end if
    mortar%cuts%x = x(:, mortar%cuts%nodes)
    if (.not. allocated(mortar%cuts%covers)) allocate (mortar%cuts%covers(mortar%slave%n), &
      mortar%cuts%area(mortar%slave%n_vertices), mortar%cuts%whole(mortar%slave%n_vertices))
    mortar%cuts%area = 0.0_DP
    mortar%cuts%whole = 0.0_DP
    do f = 1, mortar%slave%n
      call segment_facet(mortar%slave, f, mortar%depth(f), master, search, x, reach, mortar%cuts)
    end do
  end subroutine segment_facets


  !> The segments of one slave facet.
  subroutine segment_facet(slave, f, depth, master, search, x, reach, cuts)
    type(facets_type), intent(in) :: slave, master
    integer, intent(in) :: f                       !< slave facet
    real(DP), intent(in) :: depth                  !< of a line, as mortar%depth
    type(facet_search_type), intent(in) :: search
    real(DP), intent(in) :: x(:, :), reach
    type(surface_segmentation_type), intent(inout) :: cuts
    real(DP) :: corners(2, 4), size_of
    integer :: k, k_own, n_own, v(MAX_FACE_NODES), nodes(MAX_FACE_NODES)
    call facet_nodes(slave, f, n_own, nodes)
    v(:n_own) = slave%vertex(slave%first(f):slave%first(f + 1) - 1)
    associate (cover => cuts%covers(f))
      call build_segmentation(slave, f, depth, master, search, x, reach, cover)
      call project_facet_corners(cover%plane, slave, f, x, corners, k_own)
      size_of = signed_polygon_area(corners(:, :k_own)) * find_depth(cover%plane, cover%plane%origin)
      cuts%whole(v(:n_own)) = cuts%whole(v(:n_own)) + size_of * facet_integral_fractions(slave%kind(f), n_own)
      if (cover%n == 0) return
      call integrate_segments(slave, f, x, cover%plane, size_of, cover%points, cover%segments(:cover%n))
      deallocate (cover%points%on_slave, cover%points%on_master)
      do k = 1, cover%n
        cuts%area(v(:n_own)) = cuts%area(v(:n_own)) + cover%segments(k)%share(:n_own)
      end do
    end associate
  end subroutine segment_facet


  !> How fast the part that a node gives goes with its distance beyond the edge, for the part 0 to 1 that it gives.
  elemental real(DP) function evaluate_transfer_slope(beyond) result(slope)
    real(DP), intent(in) :: beyond                 !< s^2 (3 - 2 s), s = distance/(MAX_EXCESS_COMPLIANT edge) [-]
    real(DP) :: s
    s = 0.5_DP - sin(asin(1 - 2 * min(max(beyond, 0.0_DP), 1.0_DP)) / 3)
    slope = 6 * s * (1 - s) / MAX_EXCESS_COMPLIANT
  end function evaluate_transfer_slope


  !> Which nodes of a slave facet that has a master in front are over the master: under exact contact it is or it is not, under a
  !! compliant law it fades, so that forces are continuous. Of the master all facets around count, not only those with which the
  !! slave facet is cut: of these one may come or go while the node is near it.
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
        if (is_facing_plane(cover%plane, master, list(k), x, reach)) call update_node_excess(mortar, f, master, list(k), x)
      end do
    end associate
  end subroutine find_covered_nodes


  !> Which nodes of a slave facet are over one facet of the master.
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


  !> The nodes of a facet that has a master in front though none of its nodes is over it count as if they were.
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


  !> The first n parts of a whole facet that its functions take.
  pure function facet_integral_fractions(kind, n) result(share)
    integer, intent(in) :: kind, n
    real(DP) :: share(n), all_of(MAX_FACE_NODES)
    all_of = nodal_integral_fractions(kind)
    share = all_of(:n)
  end function facet_integral_fractions


  !> Places and rows of all slave nodes from the segments of the facets around them.
  subroutine fill_rows(mortar, master, x)
    type(mortar_type), intent(inout) :: mortar
    type(facets_type), intent(in) :: master
    real(DP), intent(in) :: x(:, :)
    integer, allocatable :: at(:)                  ! (n_nodes) place in the row that is filled, 0 outside
    real(DP) :: m(3)
    integer :: j, v
    allocate (at(size(x, 2)), source=0)
    do j = 1, size(mortar%nodes)
      associate (vertices => mortar%vertices(mortar%first(j):mortar%first(j + 1) - 1), place => mortar%places(j), &
        cuts => mortar%cuts)
        place = mortar_node_type()
        call fill_slave_part(mortar%nodes(j), mortar%corners(:, j), mortar%rows(j))
        mortar%rows(j)%imbalance_weights = mortar%base_rows(j)%imbalance_weights
        if (size(vertices) == 0) cycle
        v = choose_facing_vertex(mortar, vertices)
        if (abs(cuts%area(v)) <= MIN_COUNTED_FRACTION * cuts%whole(v)) cycle
        m = evaluate_vertex_normal(mortar%slave, x, v)
        if (norm2(m) <= 0.0_DP .or. (.not. mortar%is_compliant .and. mortar%transferred_fraction(j) >= 1.0_DP)) cycle
        place%vertex = v
        place%area = cuts%area(v)
        place%whole = cuts%whole(v)
        place%is_barely_covered = .not. mortar%is_compliant .and. place%area <= MIN_COVERED_FRACTION * place%whole
        place%normal = -m / norm2(m)
        call fill_master_part(mortar, master, x, at, place, mortar%rows(j))
      end associate
    end do
  end subroutine fill_rows


  !> The vertex of a slave node that is against the master: on a crease of the slave surface, as at the corner of a shank in its
  !! hole, the one whose facets are nearest of those that are covered nearly as well as the best. The area alone would choose now
  !! this, now that where faces on both sides are covered alike.
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


  !> The mean distance of the facets around a vertex from their masters; 0 if there are none.
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


  !> The master's part of a row: -M_ji / D_j, in the order in which the segments bring the nodes. Nodes beside that are beyond the
  !! master's edge give their functions to the row: their part of the slave's side is there too.
  subroutine fill_master_part(mortar, master, x, at, place, row)
    type(mortar_type), intent(in) :: mortar
    type(facets_type), intent(in) :: master
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    integer, intent(inout) :: at(:)                !< (n_nodes) 0; left so
    type(mortar_node_type), intent(inout) :: place
    type(contact_row_type), intent(inout) :: row
    real(DP), allocatable :: weights(:)
    integer, allocatable :: nodes(:)
    real(DP) :: largest, received(MAX_FACE_NODES), own_area, adjacent_area, first_moment(3), d_received(MAX_FACE_NODES, &
      MAX_FACE_NODES)
    integer :: i, s, k, n, f, own, n_head
    n = 0
    associate (slave => mortar%slave)
      do s = slave%star_first(place%vertex), slave%star_first(place%vertex + 1) - 1
        f = slave%star_facet(s)
        n = n + MAX_FACE_NODES * (mortar%cuts%covers(f)%n + 3)
      end do
      n_head = size(row%nodes)
      allocate (nodes(n))
      allocate (weights(n), source=0.0_DP)
      n = 0
      largest = -huge(1.0_DP)
      own_area = merge(0.0_DP, place%area, mortar%is_compliant)
      adjacent_area = 0.0_DP
      first_moment = 0.0_DP
      do s = slave%star_first(place%vertex), slave%star_first(place%vertex + 1) - 1
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
            place%facet = segments(k)%master
            place%xi = segments(k)%centre
          end do
          call add_adjacent_slave_nodes(mortar, f, own, received, segments)
        end associate
      end do
      at(nodes(:n)) = 0
    end associate
    place%area = own_area + adjacent_area
    if (abs(place%area) <= MIN_COUNTED_FRACTION * place%whole) then
      place = mortar_node_type()
      return
    end if
    if (adjacent_area > 0.0_DP) then
      first_moment = first_moment + own_area * evaluate_relative_position(row, x)
      row%weights = row%weights * (own_area / place%area)
      if (own_area > 0.0_DP) row%imbalance_weights = row%imbalance_weights * (place%area / own_area)
      place%force_arm = first_moment / place%area - x(:, row%nodes(1))
    end if
    do k = 1, n_head                               ! each node once
      i = findloc(nodes(:n), row%nodes(k), dim=1)
      if (i == 0) cycle
      row%weights(k) = row%weights(k) - weights(i) / place%area
      nodes(i:n - 1) = nodes(i + 1:n)
      weights(i:n - 1) = weights(i + 1:n)
      n = n - 1
    end do
    row%nodes = [row%nodes, nodes(:n)]
    row%weights = [row%weights, -weights(:n) / place%area]

  contains

    !> Adds the nodes beside that give their functions to the row, as nodes of the slave's side.
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


  !> Which parts of the functions of a facet a node of it takes: what it keeps of its own, and what those beyond the master give to
  !! the nearest that are over it. What all that are near cannot take, since they are beyond, too, those farther take; what nobody
  !! takes is kept.
  pure subroutine redistribute_functions(kind, own, beyond, received, d_received)
    integer, intent(in) :: kind                    !< FACET_...
    integer, intent(in) :: own                     !< local number of the node
    real(DP), intent(in) :: beyond(:)              !< (n) what each node gives [-]
    real(DP), intent(out) :: received(MAX_FACE_NODES) !< [-]
    real(DP), intent(out) :: d_received(MAX_FACE_NODES, MAX_FACE_NODES)   !< (i, k) of taken(i) by beyond(k) [-]
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


  !> Where the nodes of a facet are if all its edges are alike.
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


  !> Adds what one segment gives to M of a slave node.
  pure subroutine add_segment_weights(master, segment, received, at, n, nodes, weights)
    type(facets_type), intent(in) :: master
    type(mortar_segment_type), intent(in) :: segment
    real(DP), intent(in) :: received(MAX_FACE_NODES)  !< of the functions of the segment's slave facet [-]
    integer, intent(inout) :: at(:)                !< (n_nodes) place in nodes(:) or 0
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
    integer, intent(inout) :: at(:)                !< (n_nodes) place in nodes(:) or 0
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
