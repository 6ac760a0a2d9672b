!> Plan of the assembly: order of the elements, pattern of the stiffness, and the part of a rank.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! METIS divides the mesh into parts whose number depends on the mesh alone. Elements whose nodes all belong to one part are
!! scattered part by part, in parallel, since no two parts share such a node. The elements in between are coloured so that no two of
!! a colour share a node, and are scattered colour by colour. The summation order of each entry is therefore fixed, and the result
!! is bitwise the same for any number of threads.
!!
!! Several ranks divide the elements by METIS. The stiffness is whole on each rank, or divided: then each keeps the part of its own
!! elements, and products with it are summed over the ranks.
module amontons_assembly_plan
  use amontons_kinds, only: DP
  use amontons_containers, only: list_groups, sort_ascending
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: MAX_ELEMENT_NODES
  use amontons_mesh, only: mesh_type, element_nodes
  use amontons_sparse, only: sparse_type, multiply_symmetric, alike_rows
  use amontons_unsymmetric_tangent, only: skew_part_type
  use amontons_graph_partition, only: partition_mesh
  use amontons_point_partition, only: partition_points
  use amontons_mpi_ranks, only: this_rank, n_ranks, sum_over_ranks, min_over_ranks
  use amontons_solid_simd, only: batch_rule_type, create_batch_rules
  implicit none
  private
  public :: assembly_type, create_assembly, ensure_matrix, is_own_element, couple_nodes
  public :: add_node_block, add_skew_block, add_row_block
  public :: multiply_stiffness, complete_diagonal, node_diagonal, stiffness_diagonal, largest_stiffness

  integer, parameter :: ELEMENTS_PER_PART = 400       !< enough work for a thread, small enough for the cache

  !> The pattern of the stiffness and the assembly order of the elements.
  type :: assembly_type
    type(sparse_type) :: stiffness                    !< K, upper triangle by rows, all 3 n_nodes unknowns; if it is divided, the
                                                      !! part of the elements of this rank
    logical :: is_divided = .false.                   !< K is the sum of `stiffness` over the ranks
    real(DP), allocatable :: diagonal(:)              !< (3 n_nodes) of K, if it is divided [force/length]
    type(skew_part_type) :: skew                           !< unsymmetric part of the tangent
    integer, allocatable :: graph_first(:)            !< (n_nodes + 1) neighbours j >= i of each node i, itself first
    integer, allocatable :: graph_node(:)
    logical, allocatable :: is_idle(:)                !< (n_nodes) no element and no group adds to the rows of the node
    integer, allocatable :: pair_first(:)             !< (n_elements + 1) start of an element's node pairs
    integer, allocatable :: pair_offset(:)            !< position of the pair's block in the row of its lower node, from 0
    integer, allocatable :: group_first(:)            !< (n_groups + 1) start of each group in element_order
    integer, allocatable :: element_order(:)          !< elements of this rank, group by group
    integer, allocatable :: rank_of(:)                !< (n_elements) rank that evaluates it, from 0; not allocated: one rank
    integer :: own_rank = 0                           !< this one
    integer :: n_parts = 0                            !< groups 1 to n_parts run in parallel, one thread a group
    integer :: n_groups = 0                           !< groups after n_parts are colours: the elements of one run in parallel
    type(batch_rule_type), allocatable :: rules(:)          !< of the batches, by kind
  end type assembly_type

contains

  !> Builds graph, pattern and element order. Cost: linear in the size of the mesh, plus METIS.
  subroutine create_assembly(assembly, mesh, error, coupled_first, coupled_nodes, is_matrix_free, is_deferred)
    type(assembly_type), intent(out) :: assembly
    type(mesh_type), intent(in) :: mesh
    type(error_type), allocatable, intent(out) :: error
    integer, intent(in), optional :: coupled_first(:)   !< (n + 1) start of each group of nodes coupled as by an element
    integer, intent(in), optional :: coupled_nodes(:)
    logical, intent(in), optional :: is_matrix_free     !< K is not needed yet: `ensure_matrix` makes its pattern
    logical, intent(in), optional :: is_deferred      !< nor the graph, which no group of nodes extends
    type(mesh_type) :: coupled                        ! with these groups in place of elements, for the graph
    assembly%rules = create_batch_rules()
    call order_elements(assembly, mesh, error)
    if (allocated(error)) return
    allocate (assembly%is_idle(mesh%n_nodes), source=.true.)
    assembly%is_idle(mesh%nodes) = .false.
    if (present(coupled_nodes)) assembly%is_idle(coupled_nodes) = .false.
    if (present(is_deferred)) then
      if (is_deferred) return
    end if
    if (present(coupled_first)) then
      coupled%n_nodes = mesh%n_nodes
      coupled%n_elements = mesh%n_elements + size(coupled_first) - 1
      coupled%first = [mesh%first(:mesh%n_elements), coupled_first + mesh%first(mesh%n_elements + 1) - 1]
      coupled%nodes = [mesh%nodes, coupled_nodes]
      call build_graph(assembly, coupled)
    else
      call build_graph(assembly, mesh)
    end if
    if (present(is_matrix_free)) then
      if (is_matrix_free) return
    end if
    call ensure_matrix(assembly, mesh)
  end subroutine create_assembly


  !> Makes the pattern of K if there is none yet, or another one if K is to be divided or whole from now on.
  subroutine ensure_matrix(assembly, mesh, is_divided)
    type(assembly_type), intent(inout) :: assembly
    type(mesh_type), intent(in) :: mesh
    logical, intent(in), optional :: is_divided       !< over the ranks; without: as it is
    logical :: is_to_divide
    is_to_divide = assembly%is_divided
    if (present(is_divided)) is_to_divide = is_divided
    if (allocated(assembly%graph_first) .and. (is_to_divide .neqv. assembly%is_divided)) then
      deallocate (assembly%graph_first, assembly%graph_node)
      assembly%stiffness = sparse_type()
      if (allocated(assembly%pair_first)) deallocate (assembly%pair_first, assembly%pair_offset)
      if (allocated(assembly%diagonal)) deallocate (assembly%diagonal)
    end if
    if (allocated(assembly%stiffness%value)) return
    assembly%is_divided = is_to_divide
    if (.not. allocated(assembly%graph_first)) call build_graph(assembly, mesh)
    if (is_to_divide) allocate (assembly%diagonal(3 * mesh%n_nodes), source=0.0_DP)
    call build_pattern(assembly, mesh%n_nodes)
    call locate_pairs(assembly, mesh)
  end subroutine ensure_matrix


  !> Whether a rank evaluates an element.
  pure logical function is_own_element(assembly, e)
    type(assembly_type), intent(in) :: assembly
    integer, intent(in) :: e
    is_own_element = .true.
    if (allocated(assembly%rank_of)) is_own_element = assembly%rank_of(e) == assembly%own_rank
  end function is_own_element


  !> Whether this rank adds an element to its matrix: its own, or any where the matrix is whole.
  pure logical function is_in_matrix(assembly, e)
    type(assembly_type), intent(in) :: assembly
    integer, intent(in) :: e
    is_in_matrix = .true.
    if (assembly%is_divided) is_in_matrix = is_own_element(assembly, e)
  end function is_in_matrix


  !> Assigns parts by METIS to the elements of this rank, then colours to those between parts.
  subroutine order_elements(assembly, mesh, error)
    type(assembly_type), intent(inout) :: assembly
    type(mesh_type), intent(in) :: mesh
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: part(:), group(:), node_part(:)
    integer :: e, i
    logical :: is_inside
    call divide_elements(assembly, mesh, error)
    if (allocated(error)) return
    call divide_own_elements(assembly, mesh, part)
    allocate (group(mesh%n_elements), node_part(mesh%n_nodes))
    node_part = 0                                     ! 0 none yet, -1 several
    do e = 1, mesh%n_elements
      if (part(e) == 0) cycle
      do i = mesh%first(e), mesh%first(e + 1) - 1
        associate (owner => node_part(mesh%nodes(i)))
          if (owner == 0) owner = part(e)
          if (owner /= part(e)) owner = -1
        end associate
      end do
    end do
    do e = 1, mesh%n_elements
      is_inside = all(node_part(mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1)) > 0)
      group(e) = merge(part(e), 0, is_inside)
    end do
    call colour_elements(mesh, assembly%n_parts, part > 0, group, assembly%n_groups)
    where (part == 0) group = 0
    call list_groups(group, assembly%n_groups, assembly%group_first, assembly%element_order)
  end subroutine order_elements


  !> Divides the elements among the ranks.
  subroutine divide_elements(assembly, mesh, error)
    type(assembly_type), intent(inout) :: assembly
    type(mesh_type), intent(in) :: mesh
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: rank(:)                   ! from 1
    if (n_ranks() == 1) return
    call partition_mesh(mesh%n_elements, mesh%first, mesh%nodes, mesh%n_nodes, n_ranks(), rank, error=error)
    if (allocated(error)) return
    assembly%rank_of = rank - 1
    assembly%own_rank = this_rank()
  end subroutine divide_elements


  !> Divides the elements of this rank into parts by their places.
  subroutine divide_own_elements(assembly, mesh, part)
    type(assembly_type), intent(inout) :: assembly
    type(mesh_type), intent(in) :: mesh
    integer, allocatable, intent(out) :: part(:)      !< (n_elements) 0: of another rank
    integer, allocatable :: own(:), part_of_own(:)
    real(DP), allocatable :: centre(:, :)             ! (3, own elements) [length]
    integer :: e, k
    own = pack([(e, e=1, mesh%n_elements)], [(is_own_element(assembly, e), e=1, mesh%n_elements)])
    allocate (part(mesh%n_elements), source=0)
    part(own) = 1
    assembly%n_parts = 1
    if (size(own) < 2 * ELEMENTS_PER_PART) return
    allocate (centre(3, size(own)), part_of_own(size(own)))
    do k = 1, size(own)
      associate (nodes => mesh%nodes(mesh%first(own(k)):mesh%first(own(k) + 1) - 1))
        centre(:, k) = sum(mesh%coordinates(:, nodes), dim=2) / real(size(nodes), DP)
      end associate
    end do
    call partition_points(centre, ELEMENTS_PER_PART, part_of_own, assembly%n_parts)
    part(own) = part_of_own
  end subroutine divide_own_elements


  !> Gives each element of group 0 the lowest colour that none of its nodes has yet: greedy, in the order of the elements.
  pure subroutine colour_elements(mesh, n_parts, is_own, group, n_groups)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: n_parts
    logical, intent(in) :: is_own(:)                  !< (n_elements) elements to colour
    integer, intent(inout) :: group(:)                !< (n_elements) 0 becomes n_parts + colour
    integer, intent(out) :: n_groups
    integer, parameter :: N_WORDS = 8, N_BITS = 60
    integer(selected_int_kind(18)), allocatable :: used_colours(:, :)   ! (N_WORDS, n_nodes) colours in use, as bits
    integer(selected_int_kind(18)) :: taken(N_WORDS)
    integer :: e, i, colour
    allocate (used_colours(N_WORDS, mesh%n_nodes))
    used_colours = 0
    n_groups = n_parts
    do e = 1, mesh%n_elements
      if (group(e) /= 0 .or. .not. is_own(e)) cycle
      taken = 0
      do i = mesh%first(e), mesh%first(e + 1) - 1
        taken = ior(taken, used_colours(:, mesh%nodes(i)))
      end do
      colour = 0
      do while (btest(taken(colour / N_BITS + 1), mod(colour, N_BITS)))
        colour = colour + 1
      end do
      do i = mesh%first(e), mesh%first(e + 1) - 1
        associate (word => used_colours(colour / N_BITS + 1, mesh%nodes(i)))
          word = ibset(word, mod(colour, N_BITS))
        end associate
      end do
      group(e) = n_parts + colour + 1
      n_groups = max(n_groups, group(e))
    end do
  end subroutine colour_elements


  !> Neighbours j >= i of each node, ascending; of a divided matrix those by elements of this rank. Cost: linear in the node pairs
  !! of all elements.
  subroutine build_graph(assembly, mesh)
    type(assembly_type), intent(inout) :: assembly
    type(mesh_type), intent(in) :: mesh
    integer, allocatable :: element_first(:), element_list(:)
    integer :: i, n, pass
    call invert_connectivity(mesh, element_first, element_list)
    allocate (assembly%graph_first(mesh%n_nodes + 1), assembly%graph_node(0))
    assembly%graph_first(1) = 1
    do pass = 1, 2
      !$omp parallel
      call list_neighbours(assembly, mesh, element_first, element_list, pass == 1)
      !$omp end parallel
      if (pass == 2) exit
      do i = 1, mesh%n_nodes
        assembly%graph_first(i + 1) = assembly%graph_first(i) + assembly%graph_first(i + 1)
      end do
      n = assembly%graph_first(mesh%n_nodes + 1) - 1
      deallocate (assembly%graph_node)
      allocate (assembly%graph_node(n))
    end do
  end subroutine build_graph


  !> One thread's share of the nodes: counts their neighbours, or lists them.
  subroutine list_neighbours(assembly, mesh, element_first, element_list, is_counted)
    type(assembly_type), intent(inout) :: assembly
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: element_first(:), element_list(:)   !< elements at each node
    logical, intent(in) :: is_counted              !< graph_first(i + 1) becomes the number of neighbours of node i
    integer, allocatable :: mark(:)
    integer :: i, k, n, start
    allocate (mark(mesh%n_nodes), source=0)
    !$omp do schedule(static)
    do i = 1, mesh%n_nodes
      start = 0
      if (.not. is_counted) start = assembly%graph_first(i) - 1
      n = start
      call add_neighbour(i, i)                              ! nodes without elements have a diagonal entry
      do k = element_first(i), element_first(i + 1) - 1
        call add_element_neighbours(i, element_list(k))
      end do
      if (is_counted) then
        assembly%graph_first(i + 1) = n
      else
        call sort_ascending(assembly%graph_node(start + 1:n))
      end if
    end do
    !$omp end do

  contains

    !> All nodes of an element are neighbours.
    subroutine add_element_neighbours(node, e)
      integer, intent(in) :: node, e
      integer :: m
      if (.not. is_in_matrix(assembly, e)) return
      do m = mesh%first(e), mesh%first(e + 1) - 1
        call add_neighbour(node, mesh%nodes(m))
      end do
    end subroutine add_element_neighbours

    !> Records a neighbour once, if its number is not lower.
    subroutine add_neighbour(node, other)
      integer, intent(in) :: node, other
      if (other < node .or. mark(other) == node) return
      mark(other) = node
      n = n + 1
      if (.not. is_counted) assembly%graph_node(n) = other
    end subroutine add_neighbour

  end subroutine list_neighbours


  !> Elements at each node.
  pure subroutine invert_connectivity(mesh, first, list)
    type(mesh_type), intent(in) :: mesh
    integer, allocatable, intent(out) :: first(:), list(:)
    integer, allocatable :: next(:)
    integer :: e, i, n
    allocate (first(mesh%n_nodes + 1), list(size(mesh%nodes)))
    first = 0
    do i = 1, size(mesh%nodes)
      first(mesh%nodes(i) + 1) = first(mesh%nodes(i) + 1) + 1
    end do
    first(1) = 1
    do n = 1, mesh%n_nodes
      first(n + 1) = first(n) + first(n + 1)
    end do
    next = first
    do e = 1, mesh%n_elements
      do i = mesh%first(e), mesh%first(e + 1) - 1
        n = mesh%nodes(i)
        list(next(n)) = e
        next(n) = next(n) + 1
      end do
    end do
  end subroutine invert_connectivity


  !> Three rows for each node; the row of component r of node i starts with its own unknown.
  subroutine build_pattern(assembly, n_nodes)
    type(assembly_type), intent(inout) :: assembly
    integer, intent(in) :: n_nodes
    integer :: i, n
    associate (K_matrix => assembly%stiffness)
      K_matrix = sparse_type(n_rows=3 * n_nodes, n_columns=3 * n_nodes)
      allocate (K_matrix%first(3 * n_nodes + 1))
      n = 9 * size(assembly%graph_node) - 3 * n_nodes
      allocate (K_matrix%column(n), K_matrix%value(n))
      !$omp parallel do schedule(static)
      do i = 1, n_nodes
        call list_node_rows(assembly, i)
      end do
      !$omp end parallel do
      K_matrix%first(3 * n_nodes + 1) = n + 1
    end associate
    assembly%stiffness%n_alike = alike_rows(assembly%stiffness)
  end subroutine build_pattern


  !> The three rows of a node: whole blocks of its neighbours, and of its own block those columns from the diagonal on.
  pure subroutine list_node_rows(assembly, i)
    type(assembly_type), intent(inout) :: assembly
    integer, intent(in) :: i                       !< node
    integer :: r, s, k, position
    associate (graph_first => assembly%graph_first, K_matrix => assembly%stiffness)
      position = 9 * (graph_first(i) - 1) - 3 * (i - 1) + 1
      do r = 1, 3
        K_matrix%first(3 * (i - 1) + r) = position
        do k = graph_first(i), graph_first(i + 1) - 1
          do s = merge(r, 1, k == graph_first(i)), 3
            K_matrix%column(position) = 3 * (assembly%graph_node(k) - 1) + s
            position = position + 1
          end do
        end do
      end do
    end associate
  end subroutine list_node_rows


  !> The position of the block of each pair a <= b of an element's nodes, so that scattering needs no search; of a divided matrix
  !! for elements of this rank.
  subroutine locate_pairs(assembly, mesh)
    type(assembly_type), intent(inout) :: assembly
    type(mesh_type), intent(in) :: mesh
    integer :: e, n, a, b, k, nodes(MAX_ELEMENT_NODES)
    allocate (assembly%pair_first(mesh%n_elements + 1))
    assembly%pair_first(1) = 1
    do e = 1, mesh%n_elements
      n = mesh%first(e + 1) - mesh%first(e)
      if (.not. is_in_matrix(assembly, e)) n = 0
      assembly%pair_first(e + 1) = assembly%pair_first(e) + n * (n + 1) / 2
    end do
    allocate (assembly%pair_offset(assembly%pair_first(mesh%n_elements + 1) - 1))
    !$omp parallel do schedule(static) private(n, nodes, k, a, b)
    do e = 1, mesh%n_elements
      if (.not. is_in_matrix(assembly, e)) cycle
      call element_nodes(mesh, e, n, nodes)
      k = assembly%pair_first(e)
      do b = 1, n
        do a = 1, b
          assembly%pair_offset(k) = find_block_position(assembly, min(nodes(a), nodes(b)), max(nodes(a), nodes(b)))
          k = k + 1
        end do
      end do
    end do
    !$omp end parallel do
  end subroutine locate_pairs


  !> Position of a node among the neighbours of a lower one, from 0: binary search.
  pure integer function find_block_position(assembly, low, high) result(position)
    type(assembly_type), intent(in) :: assembly
    integer, intent(in) :: low, high
    integer :: left, right, middle
    left = assembly%graph_first(low)
    right = assembly%graph_first(low + 1) - 1
    do while (left < right)
      middle = (left + right) / 2
      if (assembly%graph_node(middle) < high) then
        left = middle + 1
      else
        right = middle
      end if
    end do
    position = left - assembly%graph_first(low)
  end function find_block_position


  !> K = K + block between two nodes that the pattern couples.
  pure subroutine add_node_block(assembly, low, high, block)
    type(assembly_type), intent(inout) :: assembly
    integer, intent(in) :: low, high               !< nodes, low <= high
    real(DP), intent(in) :: block(3, 3)            !< [force/length]
    call add_row_block(assembly%stiffness, low, find_block_position(assembly, low, high), block)
  end subroutine add_node_block


  !> The same in the skew-symmetric part of the tangent, which materials or user elements make nonzero.
  pure subroutine add_skew_block(assembly, low, high, block)
    type(assembly_type), intent(inout) :: assembly
    integer, intent(in) :: low, high               !< nodes, low <= high
    real(DP), intent(in) :: block(3, 3)            !< upper triangle of (k - k')/2 [force/length]
    call add_row_block(assembly%skew%elements, low, find_block_position(assembly, low, high), block)
  end subroutine add_skew_block


  !> w = K u; all ranks call it.
  subroutine multiply_stiffness(assembly, u, w)
    type(assembly_type), intent(in) :: assembly
    real(DP), intent(in) :: u(:)                   !< (3 n_nodes) the same on all ranks [length]
    real(DP), intent(out) :: w(:)                  !< (3 n_nodes) [force]
    call multiply_symmetric(assembly%stiffness, u, w)
    if (assembly%is_divided) call sum_over_ranks(w)
  end subroutine multiply_stiffness


  !> Sums the diagonal of a divided K over the ranks, after its last contribution.
  subroutine complete_diagonal(assembly)
    type(assembly_type), intent(inout) :: assembly
    if (.not. assembly%is_divided) return
    associate (K => assembly%stiffness)
      assembly%diagonal = K%value(K%first(:K%n_rows))
    end associate
    call sum_over_ranks(assembly%diagonal)
  end subroutine complete_diagonal


  !> The diagonal of K at a node [force/length].
  pure function node_diagonal(assembly, node) result(k)
    type(assembly_type), intent(in) :: assembly
    integer, intent(in) :: node
    real(DP) :: k(3)
    if (assembly%is_divided) then
      k = assembly%diagonal(3 * node - 2:3 * node)
    else
      k = assembly%stiffness%value(assembly%stiffness%first(3 * node - 2:3 * node))
    end if
  end function node_diagonal


  !> The diagonal of K [force/length].
  pure function stiffness_diagonal(assembly) result(diagonal)
    type(assembly_type), intent(in) :: assembly
    real(DP) :: diagonal(assembly%stiffness%n_rows)
    if (assembly%is_divided) then
      diagonal = assembly%diagonal
    else
      diagonal = assembly%stiffness%value(assembly%stiffness%first(:assembly%stiffness%n_rows))
    end if
  end function stiffness_diagonal


  !> The largest entry of K; of a divided one, of the part of any rank [force/length]. All ranks call it.
  real(DP) function largest_stiffness(assembly) result(largest)
    type(assembly_type), intent(in) :: assembly
    largest = maxval(abs(assembly%stiffness%value))
    if (assembly%is_divided) largest = -min_over_ranks(-largest)
  end function largest_stiffness


  !> The nodes that elements couple, as a matrix of nodes: its pattern, upper triangle.
  subroutine couple_nodes(mesh, pattern)
    type(mesh_type), intent(in) :: mesh
    type(sparse_type), intent(out) :: pattern      !< (n_nodes x n_nodes)
    type(assembly_type) :: whole
    call build_graph(whole, mesh)
    pattern%n_rows = mesh%n_nodes
    pattern%n_columns = mesh%n_nodes
    call move_alloc(whole%graph_first, pattern%first)
    call move_alloc(whole%graph_node, pattern%column)
  end subroutine couple_nodes


  !> Adds a 3 x 3 block to the three rows of a node; of a diagonal block (position 0) the upper triangle.
  pure subroutine add_row_block(matrix, node, position, block)
    type(sparse_type), intent(inout) :: matrix
    integer, intent(in) :: node
    integer, intent(in) :: position                !< of the block in the rows, from 0
    real(DP), intent(in) :: block(3, 3)            !< [force/length]
    integer :: r, s, start
    do r = 1, 3
      start = matrix%first(3 * node - 3 + r) + 3 * position - r
      do s = merge(r, 1, position == 0), 3
        matrix%value(start + s) = matrix%value(start + s) + block(r, s)
      end do
    end do
  end subroutine add_row_block

end module amontons_assembly_plan
