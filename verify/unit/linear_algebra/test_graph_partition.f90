!> Unit test of partition: balance, few shared nodes, repeatability, and orders that are permutations with little fill.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_graph_partition
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, EXIT_INTERNAL
  use amontons_sparse, only: sparse_type, sparse_from_triplets
  use amontons_graph_partition, only: partition_mesh, aggregate_elements, order_unknowns, separator_size
  use amontons_factorization, only: cholesky_type, analyse
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer, parameter :: N = 10, N_ELEMENTS = N**3, N_NODES = (N + 1)**3
  integer :: first(N_ELEMENTS + 1), nodes(8 * N_ELEMENTS)
  call make_block()
  call test_parts(2, 1.01_DP)
  call test_parts(3, 1.01_DP)
  call test_parts(12, 1.10_DP)
  call test_few()
  call test_aggregates()
  call test_weights()
  call test_order()
  call test_groups()
  call test_separator()
  call suite%finish()

contains

  !> A block of N x N x N hexahedra.
  subroutine make_block()
    integer, parameter :: BASE(4) = [0, 1, N + 2, N + 1], CORNER(8) = [BASE, BASE + (N + 1)**2]
    integer :: e, i, j, k
    do e = 1, N_ELEMENTS
      i = mod(e - 1, N)
      j = mod((e - 1) / N, N)
      k = (e - 1) / N**2
      first(e) = 8 * e - 7
      nodes(8 * e - 7:8 * e) = 1 + i + (N + 1) * j + (N + 1)**2 * k + CORNER
    end do
    first(N_ELEMENTS + 1) = 8 * N_ELEMENTS + 1
  end subroutine make_block


  !> How many nodes belong to more than one part.
  integer function n_shared(part)
    integer, intent(in) :: part(:)
    integer :: owner(N_NODES), e, k
    logical :: is_shared(N_NODES)
    owner = 0
    is_shared = .false.
    do e = 1, N_ELEMENTS
      do k = first(e), first(e + 1) - 1
        is_shared(nodes(k)) = is_shared(nodes(k)) .or. (owner(nodes(k)) /= 0 .and. owner(nodes(k)) /= part(e))
        owner(nodes(k)) = part(e)
      end do
    end do
    n_shared = count(is_shared)
  end function n_shared


  subroutine test_parts(n_parts, balance)
    integer, intent(in) :: n_parts
    real(DP), intent(in) :: balance            !< largest part over the mean
    integer, allocatable :: part(:), again(:)
    type(error_type), allocatable :: error
    integer :: sizes(n_parts), p
    call partition_mesh(N_ELEMENTS, first, nodes, N_NODES, n_parts, part, error=error)
    call suite%that('parts: no error', .not. allocated(error))
    call suite%that('parts: numbers', minval(part) == 1 .and. maxval(part) == n_parts)
    sizes = [(count(part == p), p=1, n_parts)]
    call suite%that('parts: balance', real(maxval(sizes) * n_parts, DP) <= balance * real(N_ELEMENTS, DP))
    call suite%that('parts: few shared nodes', n_shared(part) <= 200 * (n_parts - 1))
    call partition_mesh(N_ELEMENTS, first, nodes, N_NODES, n_parts, again, error=error)
    call suite%that('parts: the same again', all(part == again))
  end subroutine test_parts


  !> Aggregates: connected, of about the requested size, none over two bodies, and the same again.
  subroutine test_aggregates()
    integer, parameter :: PART_SIZE = 30
    integer, allocatable :: part(:), again(:)
    type(error_type), allocatable :: error
    integer :: two_bodies(16 * N_ELEMENTS), two_first(2 * N_ELEMENTS + 1), n_parts, p, e
    call aggregate_elements(N_ELEMENTS, first, nodes, N_NODES, PART_SIZE, part, n_parts, error)
    call suite%that('aggregates: no error', .not. allocated(error))
    call suite%that('aggregates: numbers', minval(part) == 1 .and. maxval(part) == n_parts)
    call suite%that('aggregates: sizes', all([(2 * count(part == p) >= PART_SIZE .and. 2 * count(part == p) <= 4 * PART_SIZE, &
      p=1, n_parts)]))
    call partition_mesh(N_ELEMENTS, first, nodes, N_NODES, n_parts, again, error=error)
    call suite%that('aggregates: not much less compact than parts by METIS', 2 * n_shared(part) < 3 * n_shared(again))
    call suite%that('aggregates: connected', all([(is_connected(part == p), p=1, n_parts)]))
    call aggregate_elements(N_ELEMENTS, first, nodes, N_NODES, PART_SIZE, again, n_parts, error)
    call suite%that('aggregates: the same again', all(part == again))
    two_bodies = [nodes, nodes + N_NODES]
    two_first = [(8 * e - 7, e=1, 2 * N_ELEMENTS + 1)]
    call aggregate_elements(2 * N_ELEMENTS, two_first, two_bodies, 2 * N_NODES, PART_SIZE, part, n_parts, error)
    call suite%that('aggregates: no part of two bodies', maxval(part(:N_ELEMENTS)) < minval(part(N_ELEMENTS + 1:)))
  end subroutine test_aggregates


  !> Whether some elements of the block are joined by faces.
  pure logical function is_connected(is_member)
    logical, intent(in) :: is_member(:)
    logical :: is_reached(N_ELEMENTS), before(N_ELEMENTS)
    integer, parameter :: STEPS(6) = [-1, 1, -N, N, -N**2, N**2]
    integer :: e, k
    is_reached = .false.
    is_reached(findloc(is_member, .true., dim=1)) = .true.
    do
      before = is_reached
      do e = 1, N_ELEMENTS
        do k = 1, 6
          if (is_beside(e, e + STEPS(k))) is_reached(e) = is_reached(e) .or. is_reached(min(max(e + STEPS(k), 1), N_ELEMENTS))
        end do
      end do
      is_reached = is_reached .and. is_member
      if (all(is_reached .eqv. before)) exit
    end do
    is_connected = all(is_reached .eqv. is_member)
  end function is_connected


  !> Whether two elements of the block have a common face.
  pure logical function is_beside(e, f)
    integer, intent(in) :: e, f
    integer :: d(3)
    is_beside = .false.
    if (f < 1 .or. f > N_ELEMENTS) return
    d = [mod(e - 1, N) - mod(f - 1, N), mod((e - 1) / N, N) - mod((f - 1) / N, N), (e - 1) / N**2 - (f - 1) / N**2]
    is_beside = sum(abs(d)) == 1
  end function is_beside


  !> The pattern of the cube with several unknowns a node: those of an element are all coupled. Upper triangle, zeros.
  subroutine couple(n_unknowns, matrix)
    integer, intent(in) :: n_unknowns              !< to a node
    type(sparse_type), intent(out) :: matrix
    integer, allocatable :: of_element(:), row(:), column(:)
    type(error_type), allocatable :: error
    integer :: e, i, j, n, k
    n = 8 * n_unknowns                             ! of an element
    allocate (row(N_ELEMENTS * n**2), column(N_ELEMENTS * n**2))
    k = 0
    do e = 1, N_ELEMENTS
      of_element = [((n_unknowns * (nodes(i) - 1) + j, j=1, n_unknowns), i=first(e), first(e + 1) - 1)]
      do i = 1, n
        do j = 1, n
          if (of_element(i) > of_element(j)) cycle
          k = k + 1
          row(k) = of_element(i)
          column(k) = of_element(j)
        end do
      end do
    end do
    call sparse_from_triplets(n_unknowns * N_NODES, n_unknowns * N_NODES, row(:k), column(:k), spread(0.0_DP, 1, k), matrix, error)
  end subroutine couple


  !> Three unknowns a node: the smallest separator of a cube into nearly equal halves is a layer of nodes, and the result is one
  !! layer.
  subroutine test_separator()
    type(sparse_type) :: matrix
    type(error_type), allocatable :: error
    integer :: n_separating, i
    call couple(3, matrix)
    call separator_size(matrix, [((i + 2) / 3, i=1, 3 * N_NODES)], N_NODES, n_separating, error)
    call suite%that('separator: no error', .not. allocated(error))
    call suite%that('separator: about a layer of nodes', n_separating >= 3 * (N + 1)**2 * 8 / 10 .and. &
      n_separating <= 3 * (N + 1)**2 * 12 / 10)
  end subroutine test_separator


  !> One part, and as many parts as elements or more.
  subroutine test_few()
    integer, allocatable :: part(:)
    type(error_type), allocatable :: error
    call partition_mesh(N_ELEMENTS, first, nodes, N_NODES, 1, part, error=error)
    call suite%that('one part', size(part) == N_ELEMENTS .and. all(part == 1))
    call partition_mesh(3, first, nodes, N_NODES, 3, part, error=error)
    call suite%that('as many parts as elements', all(part == [1, 2, 3]))
    call partition_mesh(3, first, nodes, N_NODES, 8, part, error=error)
    call suite%that('more parts than elements', all(part == [1, 2, 3]))
  end subroutine test_few


  !> The work grows away from one corner in all directions: the parts have equal work, not equal numbers.
  subroutine test_weights()
    integer, allocatable :: part(:)
    type(error_type), allocatable :: error
    integer :: weight(N_ELEMENTS), work(2), p, e
    do e = 1, N_ELEMENTS
      weight(e) = 1 + mod(e - 1, N)**2 + mod((e - 1) / N, N)**2 + ((e - 1) / N**2)**2
    end do
    call partition_mesh(N_ELEMENTS, first, nodes, N_NODES, 2, part, weight, error)
    work = [(sum(weight, mask=part == p), p=1, 2)]
    call suite%that('weights: equal work', maxval(work) * 100 <= 51 * sum(weight))
    call suite%that('weights: unequal numbers', abs(count(part == 1) - N_ELEMENTS / 2) > N_ELEMENTS / 20)
  end subroutine test_weights


  !> Every number from 1 to n once.
  logical function is_permutation(order, n)
    integer, intent(in) :: order(:), n
    logical :: seen(n)
    integer :: k
    is_permutation = size(order) == n .and. all(order >= 1) .and. all(order <= n)
    if (.not. is_permutation) return
    seen = .false.
    do k = 1, n
      seen(order(k)) = .true.
    end do
    is_permutation = all(seen)
  end function is_permutation


  subroutine test_order()
    type(sparse_type) :: graph
    type(cholesky_type) :: factor
    type(error_type), allocatable :: error
    integer, allocatable :: order(:), again(:)
    real(DP) :: natural
    integer :: k
    call couple(1, graph)
    call order_unknowns(graph, [(k, k=1, N_NODES)], N_NODES, order, error)
    call suite%that('order: no error', .not. allocated(error))
    call suite%that('order: a permutation', is_permutation(order, N_NODES))
    call order_unknowns(graph, [(k, k=1, N_NODES)], N_NODES, again, error)
    call suite%that('order: the same again', all(order == again))
    call analyse(factor, graph, [(k, k=1, N_NODES)], error)
    natural = factor%n_operations
    call analyse(factor, graph, order, error)
    call suite%that('order: less than half the work of the natural order', factor%n_operations < 0.5_DP * natural)
    call sparse_from_triplets(3, 3, [1, 2, 3], [1, 2, 3], [1.0_DP, 1.0_DP, 1.0_DP], graph, error)
    call order_unknowns(graph, [1, 2, 3], 3, order, error)
    call suite%that('order: no edges', is_permutation(order, 3))
    call sparse_from_triplets(0, 0, [integer ::], [integer ::], [real(DP) ::], graph, error)
    call order_unknowns(graph, [integer ::], 0, order, error)
    call suite%that('order: nothing', size(order) == 0)
  end subroutine test_order


  !> Unknowns of a group stay together, also when the numbers of the groups interleave.
  subroutine test_groups()
    type(sparse_type) :: matrix
    type(cholesky_type) :: factor
    type(error_type), allocatable :: error
    integer, allocatable :: order(:), group(:)
    real(DP) :: by_metis
    integer :: k
    allocate (group(3 * N_NODES))
    call couple(3, matrix)
    do k = 1, N_NODES
      group(3 * k - 2:3 * k) = k
    end do
    call order_unknowns(matrix, group, N_NODES + 2, order, error)   ! two groups are empty
    call suite%that('groups: no error', .not. allocated(error))
    call suite%that('groups: a permutation', is_permutation(order, 3 * N_NODES))
    call suite%that('groups: together', all(group(order(1::3)) == group(order(3::3))))
    call analyse(factor, matrix, error=error)
    by_metis = factor%n_operations
    call analyse(factor, matrix, order, error)
    call suite%that('groups: about the work of METIS on the unknowns', factor%n_operations < 1.3_DP * by_metis)
    group = [(mod(k - 1, N_NODES) + 1, k=1, 3 * N_NODES)]           ! interleaved: far from the structure, still valid
    call order_unknowns(matrix, group, N_NODES, order, error)
    call suite%that('interleaved groups: a permutation', is_permutation(order, 3 * N_NODES))
    call suite%that('interleaved groups: together', all(group(order(1::3)) == group(order(3::3))))
    call order_unknowns(matrix, group, N_NODES - 1, order, error)
    call suite%that('groups that do not fit: reported', allocated(error))
    if (allocated(error)) call suite%that('groups that do not fit: internal', error%code == EXIT_INTERNAL)
  end subroutine test_groups

end program test_graph_partition
