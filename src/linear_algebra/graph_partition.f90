!> METIS interface: mesh partitions and fill-reducing orderings.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! METIS runs with its default options, which fix the seed of its random numbers: the same input gives the same parts.
!! It uses the single random generator of the C library; a critical section therefore serializes the calls of several jobs.
!! Reference: Karypis and Kumar, SIAM J. Scientific Computing 20 (1998) 359.
module amontons_graph_partition
  use, intrinsic :: iso_c_binding, only: c_f_pointer, c_int, c_int32_t, c_null_ptr, c_ptr
  use amontons_containers, only: list_groups
  use amontons_errors, only: error_type, set_error, EXIT_SOLVER, EXIT_INTERNAL
  use amontons_sparse, only: sparse_type
  implicit none
  private
  public :: partition_mesh, aggregate_elements, order_unknowns, nodes_by_first_use, order_unknowns_by_node, separator_size, &
    graph_separator_size

  integer, parameter :: METIS_OK = 1             !< of metis.h
  integer, parameter :: METIS_NO_MEMORY = -3     !< of metis.h
  integer(c_int32_t), parameter :: MIN_COMMON_NODES = 3    !< elements with so many common nodes are neighbours: a face
  integer, parameter :: MAX_BISECTION_PARTS = 8        !< METIS recommends bisection up to 8 parts, k-way beyond

  interface
    function metis_mesh_to_dual(n_elements, n_nodes, first, nodes, n_common, numbering, graph_first, neighbours) &
      bind(C, name='METIS_MeshToDual') result(status)
      import :: c_int32_t, c_int, c_ptr
      integer(c_int32_t), intent(in) :: n_elements, n_nodes, first(*), nodes(*), n_common, numbering
      type(c_ptr), intent(out) :: graph_first, neighbours
      integer(c_int) :: status
    end function metis_mesh_to_dual

    function metis_bisect(n, n_weights, first, neighbours, weight, vsize, edge_weight, n_parts, targets, balance, &
                          options, cut, part) bind(C, name='METIS_PartGraphRecursive') result(status)
      import :: c_int32_t, c_int, c_ptr
      integer(c_int32_t), intent(in) :: n, n_weights
      type(c_ptr), value :: first, neighbours
      integer(c_int32_t), intent(in), optional :: weight(*)
      type(c_ptr), value :: vsize, edge_weight
      integer(c_int32_t), intent(in) :: n_parts
      type(c_ptr), value :: targets, balance, options
      integer(c_int32_t), intent(out) :: cut, part(*)
      integer(c_int) :: status
    end function metis_bisect

    function metis_kway(n, n_weights, first, neighbours, weight, vsize, edge_weight, n_parts, targets, balance, &
                        options, cut, part) bind(C, name='METIS_PartGraphKway') result(status)
      import :: c_int32_t, c_int, c_ptr
      integer(c_int32_t), intent(in) :: n, n_weights
      type(c_ptr), value :: first, neighbours
      integer(c_int32_t), intent(in), optional :: weight(*)
      type(c_ptr), value :: vsize, edge_weight
      integer(c_int32_t), intent(in) :: n_parts
      type(c_ptr), value :: targets, balance, options
      integer(c_int32_t), intent(out) :: cut, part(*)
      integer(c_int) :: status
    end function metis_kway

    function metis_node_nd(n, first, neighbours, weight, options, order, place) &
      bind(C, name='METIS_NodeND') result(status)
      import :: c_int32_t, c_int, c_ptr
      integer(c_int32_t), intent(in) :: n, first(*), neighbours(*)
      integer(c_int32_t), intent(in), optional :: weight(*)
      type(c_ptr), value :: options
      integer(c_int32_t), intent(out) :: order(*), place(*)
      integer(c_int) :: status
    end function metis_node_nd

    function metis_separator(n, first, neighbours, weight, options, size, part) &
      bind(C, name='METIS_ComputeVertexSeparator') result(status)
      import :: c_int32_t, c_int, c_ptr
      integer(c_int32_t), intent(in) :: n, first(*), neighbours(*), weight(*)
      type(c_ptr), value :: options
      integer(c_int32_t), intent(out) :: size, part(*)
      integer(c_int) :: status
    end function metis_separator

    function metis_free(memory) bind(C, name='METIS_Free') result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: memory
      integer(c_int) :: status
    end function metis_free
  end interface

contains

  !> Divides the elements into connected parts of about equal work with few nodes between them.
  subroutine partition_mesh(n_elements, first, nodes, n_nodes, n_parts, part, weight, error)
    integer, intent(in) :: n_elements
    integer, intent(in) :: first(:)                    !< (n_elements + 1) start of an element's nodes
    integer, intent(in) :: nodes(:)                    !< node indices, from 1
    integer, intent(in) :: n_nodes
    integer, intent(in) :: n_parts
    integer, allocatable, intent(out) :: part(:)       !< (n_elements) 1 to n_parts
    integer, intent(in), optional :: weight(:)         !< (n_elements) work of each element; default equal
    type(error_type), allocatable, intent(out) :: error
    type(c_ptr) :: graph_first, neighbours
    integer(c_int32_t) :: cut
    integer :: status, e
    part = [(min(e, n_parts), e=1, n_elements)]
    if (n_parts <= 1 .or. n_elements <= n_parts) return
    status = metis_mesh_to_dual(n_elements, n_nodes, first - 1, nodes - 1, MIN_COMMON_NODES, 0, graph_first, neighbours)
    call check_status(status, error)
    if (allocated(error)) return
    !$omp critical (metis)
    if (n_parts <= MAX_BISECTION_PARTS) then
      status = metis_bisect(n_elements, 1, graph_first, neighbours, weight, c_null_ptr, c_null_ptr, n_parts, &
                            c_null_ptr, c_null_ptr, c_null_ptr, cut, part)
    else
      status = metis_kway(n_elements, 1, graph_first, neighbours, weight, c_null_ptr, c_null_ptr, n_parts, &
                          c_null_ptr, c_null_ptr, c_null_ptr, cut, part)
    end if
    !$omp end critical (metis)
    part = part + 1
    call check_status(status, error)
    status = metis_free(graph_first)
    status = metis_free(neighbours)
  end subroutine partition_mesh


  !> Divides the elements into many small connected parts: each grows breadth-first from an element beside the parts before it. A
  !! remainder of less than half the size joins a neighbour. Cost: linear; METIS takes n log n.
  !! Reference: Farhat, Computers and Structures 28 (1988) 579.
  subroutine aggregate_elements(n_elements, first, nodes, n_nodes, part_size, part, n_parts, error)
    integer, intent(in) :: n_elements
    integer, intent(in) :: first(:)                    !< (n_elements + 1) start of an element's nodes
    integer, intent(in) :: nodes(:)                    !< node indices, from 1
    integer, intent(in) :: n_nodes
    integer, intent(in) :: part_size                   !< elements of a part
    integer, allocatable, intent(out) :: part(:)       !< (n_elements) 1 to n_parts
    integer, intent(out) :: n_parts
    type(error_type), allocatable, intent(out) :: error
    type(c_ptr) :: graph_first, neighbours
    integer(c_int32_t), pointer :: start(:), neighbour(:)
    integer :: status
    n_parts = 0
    allocate (part(n_elements), source=0)
    if (n_elements == 0) return
    status = metis_mesh_to_dual(n_elements, n_nodes, first - 1, nodes - 1, MIN_COMMON_NODES, 0, graph_first, neighbours)
    call check_status(status, error)
    if (allocated(error)) return
    call c_f_pointer(graph_first, start, [n_elements + 1])
    call c_f_pointer(neighbours, neighbour, [max(1, start(n_elements + 1))])
    call grow_parts(start, neighbour, part_size, part, n_parts)
    status = metis_free(graph_first)
    status = metis_free(neighbours)
  end subroutine aggregate_elements


  !> The parts of aggregate_elements; elements beside a part wait as seeds of the next ones.
  pure subroutine grow_parts(start, neighbour, part_size, part, n_parts)
    integer(c_int32_t), intent(in) :: start(:), neighbour(:)   !< graph of the elements, from 0
    integer, intent(in) :: part_size
    integer, intent(inout) :: part(:)                  !< in: 0
    integer, intent(out) :: n_parts
    integer :: seeds(size(part)), members(max(1, part_size)), n_members, head, tail, e, k, p
    logical :: is_seed(size(part))
    is_seed = .false.
    n_parts = 0
    head = 0
    tail = 0
    do e = 1, size(part)
      if (part(e) > 0) cycle
      tail = tail + 1                                  ! of a body that no part has reached
      seeds(tail) = e
      is_seed(e) = .true.
      do while (head < tail)
        head = head + 1
        if (part(seeds(head)) > 0) cycle
        call grow_part(start, neighbour, seeds(head), n_parts + 1, part, members, n_members)
        call join_remainder(start, neighbour, members(:n_members), part_size, part, n_parts)
        do k = 1, n_members
          do p = start(members(k)) + 1, start(members(k) + 1)
            if (part(neighbour(p) + 1) > 0 .or. is_seed(neighbour(p) + 1)) cycle
            tail = tail + 1
            seeds(tail) = neighbour(p) + 1
            is_seed(seeds(tail)) = .true.
          end do
        end do
      end do
    end do
  end subroutine grow_parts


  !> Grows one part breadth-first.
  pure subroutine grow_part(start, neighbour, seed, number, part, members, n_members)
    integer(c_int32_t), intent(in) :: start(:), neighbour(:)
    integer, intent(in) :: seed                        !< its first element
    integer, intent(in) :: number                      !< of the part
    integer, intent(inout) :: part(:)                  !< 0: free
    integer, intent(inout) :: members(:)               !< (part_size) its elements
    integer, intent(out) :: n_members
    integer :: k, p
    members(1) = seed
    part(seed) = number
    n_members = 1
    k = 0
    do while (k < n_members)
      k = k + 1
      do p = start(members(k)) + 1, start(members(k) + 1)
        if (n_members == size(members)) return
        if (part(neighbour(p) + 1) > 0) cycle
        n_members = n_members + 1
        members(n_members) = neighbour(p) + 1
        part(members(n_members)) = number
      end do
    end do
  end subroutine grow_part


  !> Keeps a new part, or joins it to a neighbour if it is a small remainder.
  pure subroutine join_remainder(start, neighbour, members, part_size, part, n_parts)
    integer(c_int32_t), intent(in) :: start(:), neighbour(:)
    integer, intent(in) :: members(:)                  !< elements of part n_parts + 1
    integer, intent(in) :: part_size
    integer, intent(inout) :: part(:)
    integer, intent(inout) :: n_parts
    integer :: k, p
    if (2 * size(members) < part_size) then
      do k = 1, size(members)
        do p = start(members(k)) + 1, start(members(k) + 1)
          if (part(neighbour(p) + 1) == 0 .or. part(neighbour(p) + 1) > n_parts) cycle
          part(members) = part(neighbour(p) + 1)
          return
        end do
      end do
    end if
    n_parts = n_parts + 1
  end subroutine join_remainder


  !> Fill-reducing order of the vertices of a graph by nested dissection.
  subroutine order_nodes(graph, order, weight, error)
    type(sparse_type), intent(in) :: graph             !< upper triangle of the pattern; its values are not used
    integer, allocatable, intent(out) :: order(:)      !< (n) vertex that comes k-th
    integer, intent(in), optional :: weight(:)         !< (n) unknowns of each vertex; default equal
    type(error_type), allocatable, intent(out) :: error
    integer(c_int32_t), allocatable :: first(:), neighbours(:)
    integer(c_int32_t) :: place(graph%n_rows)
    integer :: status
    allocate (order(graph%n_rows))
    if (graph%n_rows == 0) return
    call symmetrize_graph(graph, first, neighbours)
    if (size(neighbours) == 0) then
      order = [(status, status=1, graph%n_rows)]
      return
    end if
    !$omp critical (metis)
    status = metis_node_nd(graph%n_rows, first, neighbours, weight, c_null_ptr, order, place)
    !$omp end critical (metis)
    order = order + 1
    call check_status(status, error)
  end subroutine order_nodes


  !> The graph in the format of METIS: zero-based, both directions, no loops, no duplicates.
  pure subroutine symmetrize_graph(graph, first, neighbours)
    type(sparse_type), intent(in) :: graph             !< pairs in one direction; some may appear in both
    integer(c_int32_t), allocatable, intent(out) :: first(:) !< (n + 1)
    integer(c_int32_t), allocatable, intent(out) :: neighbours(:)
    integer :: next(graph%n_rows), i, j, p
    allocate (first(graph%n_rows + 1))
    first = 0
    do i = 1, graph%n_rows
      do p = graph%first(i), graph%first(i + 1) - 1
        j = graph%column(p)
        if (j == i) cycle
        first(i + 1) = first(i + 1) + 1
        first(j + 1) = first(j + 1) + 1
      end do
    end do
    do i = 1, graph%n_rows
      first(i + 1) = first(i) + first(i + 1)
    end do
    next = first(:graph%n_rows) + 1
    allocate (neighbours(first(graph%n_rows + 1)))
    do i = 1, graph%n_rows
      do p = graph%first(i), graph%first(i + 1) - 1
        j = graph%column(p)
        if (j == i) cycle
        neighbours(next(i)) = j - 1
        neighbours(next(j)) = i - 1
        next(i) = next(i) + 1
        next(j) = next(j) + 1
      end do
    end do
    call remove_duplicate_neighbours(graph%n_rows, first, neighbours)
  end subroutine symmetrize_graph


  !> Removes duplicate neighbours.
  pure subroutine remove_duplicate_neighbours(n, first, neighbours)
    integer, intent(in) :: n
    integer(c_int32_t), intent(inout) :: first(:)            !< (n + 1) from 0
    integer(c_int32_t), allocatable, intent(inout) :: neighbours(:)
    integer :: seen(n), i, p, n_kept, start
    seen = 0
    n_kept = 0
    start = 0
    do i = 1, n
      do p = start + 1, first(i + 1)
        if (seen(neighbours(p) + 1) == i) cycle
        seen(neighbours(p) + 1) = i
        n_kept = n_kept + 1
        neighbours(n_kept) = neighbours(p)
      end do
      start = first(i + 1)
      first(i + 1) = n_kept
    end do
    neighbours = neighbours(:n_kept)
  end subroutine remove_duplicate_neighbours


  !> Fill-reducing order of unknowns in groups (those of a node): the groups are ordered, weighted by their
  !> sizes, and each is expanded. The result is a permutation for `analyse` of `factorization`.
  subroutine order_unknowns(matrix, group, n_groups, order, error)
    type(sparse_type), intent(in) :: matrix            !< symmetric, upper triangle
    integer, intent(in) :: group(:)                    !< (n) group of each unknown, 1 to n_groups
    integer, intent(in) :: n_groups                    !< groups may be empty
    integer, allocatable, intent(out) :: order(:)      !< (n) unknown that comes k-th
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: graph
    integer, allocatable :: group_order(:), first(:), members(:)
    integer :: g, k, n
    if (size(group) /= matrix%n_rows .or. any(group < 1) .or. any(group > n_groups)) then
      call set_error(error, EXIT_INTERNAL, 'The groups of the unknowns do not fit the matrix.')
      return
    end if
    call list_groups(group, n_groups, first, members)
    call group_graph(matrix, group, n_groups, first, members, graph)
    call order_nodes(graph, group_order, max(1, first(2:) - first(:n_groups)), error)
    if (allocated(error)) return
    allocate (order(matrix%n_rows))
    n = 0
    do k = 1, n_groups
      g = group_order(k)
      order(n + 1:n + first(g + 1) - first(g)) = members(first(g):first(g + 1) - 1)
      n = n + first(g + 1) - first(g)
    end do
  end subroutine order_unknowns


  !> The size of the first separator of a matrix [unknowns]: it comes last in the order and dominates the cost of the factor. It
  !! takes a tenth of the time of the order.
  subroutine separator_size(matrix, group, n_groups, n_separating, error)
    type(sparse_type), intent(in) :: matrix            !< symmetric, upper triangle
    integer, intent(in) :: group(:)                    !< (n) group of each unknown, 1 to n_groups
    integer, intent(in) :: n_groups                    !< groups may be empty
    integer, intent(out) :: n_separating
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: graph
    integer, allocatable :: first(:), members(:)
    call list_groups(group, n_groups, first, members)
    call group_graph(matrix, group, n_groups, first, members, graph)
    call graph_separator_size(graph, first(2:) - first(:n_groups), n_separating, error)
  end subroutine separator_size


  !> The same of a graph of the groups.
  subroutine graph_separator_size(graph, n_members, n_separating, error)
    type(sparse_type), intent(in) :: graph             !< pattern only: each pair once
    integer, intent(in) :: n_members(:)                !< unknowns of each group
    integer, intent(out) :: n_separating
    type(error_type), allocatable, intent(out) :: error
    integer(c_int32_t), allocatable :: first(:), neighbours(:)
    integer(c_int32_t) :: part(graph%n_rows), weight(graph%n_rows)
    integer :: status
    n_separating = 0
    call symmetrize_graph(graph, first, neighbours)
    if (size(neighbours) == 0) return
    weight = max(1, n_members)
    !$omp critical (metis)
    status = metis_separator(graph%n_rows, first, neighbours, weight, c_null_ptr, n_separating, part)
    !$omp end critical (metis)
    call check_status(status, error)
  end subroutine graph_separator_size


  !> The graph of groups coupled by a matrix of their members. A pair may occur from either side, or from both.
  pure subroutine group_graph(matrix, group, n_groups, first, members, graph)
    type(sparse_type), intent(in) :: matrix            !< upper triangle
    integer, intent(in) :: group(:), n_groups, first(:), members(:)
    type(sparse_type), intent(out) :: graph            !< pattern only; columns not sorted
    integer :: seen(n_groups), pass, g, h, m, p, n
    graph%n_rows = n_groups
    graph%n_columns = n_groups
    allocate (graph%first(n_groups + 1))
    do pass = 1, 2   ! count, then fill
      seen = 0
      n = 0
      do g = 1, n_groups
        graph%first(g) = n + 1
        do m = first(g), first(g + 1) - 1
          do p = matrix%first(members(m)), matrix%first(members(m) + 1) - 1
            h = group(matrix%column(p))
            if (h == g .or. seen(h) == g) cycle
            seen(h) = g
            n = n + 1
            if (pass == 2) graph%column(n) = h
          end do
        end do
      end do
      graph%first(n_groups + 1) = n + 1
      if (pass == 1) allocate (graph%column(n))
    end do
  end subroutine group_graph


  !> The nodes in order of first appearance; nodes that do not appear come last.
  pure function nodes_by_first_use(sequence, n_nodes) result(order)
    integer, intent(in) :: sequence(:)             !< nodes of the unknowns, in the order of the unknowns
    integer, intent(in) :: n_nodes
    integer :: order(n_nodes)
    logical :: is_met(n_nodes)
    integer :: i, n
    is_met = .false.
    n = 0
    do i = 1, size(sequence)
      if (is_met(sequence(i))) cycle
      is_met(sequence(i)) = .true.
      n = n + 1
      order(n) = sequence(i)
    end do
    do i = 1, n_nodes
      if (is_met(i)) cycle
      n = n + 1
      order(n) = i
    end do
  end function nodes_by_first_use


  !> The unknowns in the order of their nodes. The unknowns of a node must be contiguous.
  pure function order_unknowns_by_node(node_order, node) result(order)
    integer, intent(in) :: node_order(:)           !< (n_nodes)
    integer, intent(in) :: node(:)                 !< (n_free) node of each unknown, ascending
    integer :: order(size(node))
    integer :: first(size(node_order) + 1), i, k, n
    first = 0
    do i = 1, size(node)
      first(node(i) + 1) = first(node(i) + 1) + 1
    end do
    first(1) = 1
    do i = 1, size(node_order)
      first(i + 1) = first(i) + first(i + 1)
    end do
    n = 0
    do k = 1, size(node_order)
      do i = first(node_order(k)), first(node_order(k) + 1) - 1
        n = n + 1
        order(n) = i
      end do
    end do
  end function order_unknowns_by_node


  !> The error for a status of METIS.
  subroutine check_status(status, error)
    integer, intent(in) :: status
    type(error_type), allocatable, intent(out) :: error
    select case (status)
    case (METIS_OK)
    case (METIS_NO_MEMORY)
      call set_error(error, EXIT_SOLVER, 'Not enough memory for METIS.')
    case default
      call set_error(error, EXIT_INTERNAL, 'METIS did not accept the mesh or graph.')
    end select
  end subroutine check_status

end module amontons_graph_partition
