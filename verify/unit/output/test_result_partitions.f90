!> Partitions: each element once, complete grids, sets, the joined order, ranks.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_result_partitions
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_mesh, only: finalize_mesh, mesh_type, set_type
  use amontons_model, only: model_type
  use amontons_result_partitions, only: partition_type, divide_model, join_partitions, extract_mesh, first_places, &
    partition_ending, writing_rank
  use check, only: suite_type
  implicit none
  integer, parameter :: N = 12                    !< elements
  type(suite_type) :: suite

  call test_division(suite)
  call test_extract(suite)
  call test_names(suite)
  call suite%finish()

contains

  !> A row of bricks, and two nodes without elements.
  subroutine make_model(model)
    type(model_type), intent(out) :: model
    integer :: e, i
    associate (mesh => model%mesh)
      mesh%n_nodes = 4 * (N + 1) + 2
      mesh%n_elements = N
      allocate (mesh%coordinates(3, mesh%n_nodes))
      do i = 1, mesh%n_nodes
        mesh%coordinates(:, i) = real([(i - 1) / 4, mod(i / 2, 2), mod((i - 1) / 2, 2)], DP)
      end do
      mesh%kind = spread(KIND_C3D8, 1, N)
      mesh%first = [(1 + 8 * e, e=0, N)]
      mesh%nodes = [((4 * e + i, i=1, 8), e=0, N - 1)]
      mesh%node_label = [(10 * i, i=1, mesh%n_nodes)]
      mesh%element_label = [(100 + e, e=1, N)]
      allocate (mesh%material(N), source=1)
      call finalize_mesh(mesh)
      mesh%node_sets = [set_type('ends', [mesh%n_nodes - 2, 1])]
      mesh%element_sets = [set_type('all', [(e, e=N, 1, -1)])]
    end associate
    allocate (model%pairs(0))
  end subroutine make_model


  !> Each element is in one partition, each node of an element with it; sizes are about equal; no more partitions than elements.
  subroutine test_division(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(partition_type), allocatable :: partitions(:)
    type(partition_type) :: whole
    type(error_type), allocatable :: error
    integer :: wanted, p, e, i
    integer, allocatable :: place(:)
    logical :: is_complete
    call make_model(model)
    do wanted = 1, 20
      call divide_model(model, wanted, partitions, error)
      call suite%that('divided', .not. allocated(error))
      call suite%that('so many', size(partitions) == min(wanted, N) .or. wanted > 4 .and. size(partitions) < wanted)
      whole = join_partitions(partitions)
      call suite%that('each element once', size(whole%elements) == N .and. all(first_places(whole%elements, N) > 0))
      call suite%that('each node', all(first_places(whole%nodes, model%mesh%n_nodes) > 0))
      call suite%that('points', whole%n_points == model%mesh%n_points .and. whole%n_ids == size(model%mesh%nodes))
      is_complete = .true.
      do p = 1, size(partitions)
        do e = 1, size(partitions(p)%elements)
          i = partitions(p)%elements(e)
          place = first_places(partitions(p)%nodes, model%mesh%n_nodes)
          is_complete = is_complete .and. all(place(model%mesh%nodes(8 * i - 7:8 * i)) > 0)
        end do
      end do
      call suite%that('complete', is_complete)
      if (wanted == 2) call suite%that('halves with a face in common', size(partitions(1)%elements) == N / 2 .and. &
        size(whole%nodes) == model%mesh%n_nodes + 4)
    end do
  end subroutine test_division


  !> The grid of a partition: nodes where the model has them, labels, sets in their order.
  subroutine test_extract(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(mesh_type) :: extract
    type(partition_type), allocatable :: partitions(:)
    type(error_type), allocatable :: error
    integer :: p, e
    logical :: is_equal
    call make_model(model)
    call divide_model(model, 2, partitions, error)
    is_equal = .true.
    do p = 1, 2
      call extract_mesh(model%mesh, partitions(p), extract)
      do e = 1, extract%n_elements
        associate (old => model%mesh%nodes(8 * partitions(p)%elements(e) - 7:8 * partitions(p)%elements(e)), &
          new => extract%nodes(extract%first(e):extract%first(e + 1) - 1))
          is_equal = is_equal .and. all(extract%node_label(new) == model%mesh%node_label(old)) .and. &
            all(abs(extract%coordinates(:, new) - model%mesh%coordinates(:, old)) <= 0.0_DP)
        end associate
      end do
      is_equal = is_equal .and. extract%point_first(extract%n_elements + 1) == extract%n_points + 1
      call suite%that('set of elements', all(extract%element_sets(1)%members == [(e, e=extract%n_elements, 1, -1)]))
    end do
    call suite%that('its elements have their nodes', is_equal)
    call extract_mesh(model%mesh, join_partitions(partitions), extract)
    call suite%that('both: a node once', all(extract%node_label(extract%node_sets(1)%members) == &
      [10 * (model%mesh%n_nodes - 2), 10]))
  end subroutine test_extract


  !> Endings, and ranks: the first of each group; several partitions a rank where there are more.
  subroutine test_names(suite)
    type(suite_type), intent(inout) :: suite
    integer :: p
    call suite%that('ending', partition_ending(12) == '.partition-0012.vtkhdf')
    call suite%that('two groups of four ranks', all([(writing_rank(p, 2, 4), p=1, 2)] == [0, 2]))
    call suite%that('as many', all([(writing_rank(p, 3, 3), p=1, 3)] == [0, 1, 2]))
    call suite%that('five on two', all([(writing_rank(p, 5, 2), p=1, 5)] == [0, 0, 0, 1, 1]))
  end subroutine test_names

end program test_result_partitions
