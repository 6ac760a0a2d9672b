!> Partitions of the result file: elements and nodes of each, their meshes, and the rank that writes them.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Each element belongs to one partition; a node belongs to every partition that has one of its elements, so that the grid of a
!! partition is complete. METIS divides the elements of the mesh alone: the partitions depend neither on the number of ranks nor on
!! the time. Nodes without elements are dealt out in the order of the deck; analytic surfaces are drawn in the last partition.
module amontons_result_partitions
  use amontons_containers, only: sort_integers
  use amontons_errors, only: error_type
  use amontons_mesh, only: mesh_type, set_type
  use amontons_model, only: model_type
  use amontons_graph_partition, only: partition_mesh
  use amontons_nodal_fields, only: list_slave_edges
  implicit none
  private
  public :: partition_type, divide_model, join_partitions, extract_mesh, first_places, partition_ending, writing_rank

  !> Elements and nodes of a partition in the order of its file: that of the deck.
  type :: partition_type
    integer, allocatable :: elements(:)
    integer, allocatable :: nodes(:)
    integer :: n_points = 0                       !< integration points
    integer :: n_ids = 0                          !< nodes of all its elements, one after the other
  end type partition_type

contains

  !> Divides the model. Cost: METIS and sorting, n log n. Errors: those of METIS.
  subroutine divide_model(model, n_wanted, partitions, error)
    type(model_type), intent(in) :: model
    integer, intent(in) :: n_wanted               !< there are fewer where some would have no element
    type(partition_type), allocatable, intent(out) :: partitions(:)
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: part(:), number(:)
    integer :: p, n
    associate (mesh => model%mesh)
      call partition_mesh(mesh%n_elements, mesh%first, mesh%nodes, mesh%n_nodes, n_wanted, part, error=error)
    end associate
    if (allocated(error)) return
    allocate (number(n_wanted), source=0)
    number(part) = 1
    n = 0
    do p = 1, n_wanted
      n = n + number(p)
      number(p) = n
    end do
    allocate (partitions(max(1, n)))
    call list_elements(model%mesh, number(part), partitions)
    call list_nodes(model, partitions)
  end subroutine divide_model


  !> The elements of each partition, ascending, and the numbers of their points and nodes.
  pure subroutine list_elements(mesh, part, partitions)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: part(:)                !< (n_elements) from 1
    type(partition_type), intent(inout) :: partitions(:)
    integer :: n(size(partitions)), p, e
    n = 0
    do e = 1, size(part)
      n(part(e)) = n(part(e)) + 1
    end do
    do p = 1, size(partitions)
      allocate (partitions(p)%elements(n(p)))
    end do
    n = 0
    do e = 1, size(part)
      p = part(e)
      n(p) = n(p) + 1
      partitions(p)%elements(n(p)) = e
      partitions(p)%n_points = partitions(p)%n_points + mesh%point_first(e + 1) - mesh%point_first(e)
      partitions(p)%n_ids = partitions(p)%n_ids + mesh%first(e + 1) - mesh%first(e)
    end do
  end subroutine list_elements


  !> The nodes of each partition, ascending: those of its elements, its share of the nodes without elements, and the corners beside
  !! its mid-side nodes of slave faces.
  subroutine list_nodes(model, partitions)
    type(model_type), intent(in) :: model
    type(partition_type), intent(inout) :: partitions(:)
    integer, allocatable :: idle(:), edges(:, :)
    integer :: marker(model%mesh%n_nodes), list(model%mesh%n_nodes), p, e, i, n
    call list_slave_edges(model, edges)
    marker = 0
    associate (mesh => model%mesh)
      idle = pack([(i, i=1, mesh%n_nodes)], .not. mesh%has_elements)
      do p = 1, size(partitions)
        n = 0
        do e = 1, size(partitions(p)%elements)
          do i = mesh%first(partitions(p)%elements(e)), mesh%first(partitions(p)%elements(e) + 1) - 1
            call add(mesh%nodes(i))
          end do
        end do
        do i = p, size(idle), size(partitions)
          call add(idle(i))
        end do
        do i = 1, size(edges, 2)
          if (marker(edges(1, i)) /= p) cycle
          call add(edges(2, i))
          call add(edges(3, i))
        end do
        partitions(p)%nodes = list(:n)
        call sort_integers(partitions(p)%nodes)
      end do
    end associate

  contains

    !> A node that this partition may have already.
    subroutine add(node)
      integer, intent(in) :: node
      if (marker(node) == p) return
      marker(node) = p
      n = n + 1
      list(n) = node
    end subroutine add

  end subroutine list_nodes


  !> All partitions, one after the other: the order of the file that ties them. Nodes of several partitions come as often.
  pure function join_partitions(partitions) result(whole)
    type(partition_type), intent(in) :: partitions(:)
    type(partition_type) :: whole
    integer :: p, i, k
    allocate (whole%elements(sum([(size(partitions(p)%elements), p=1, size(partitions))])), &
      whole%nodes(sum([(size(partitions(p)%nodes), p=1, size(partitions))])))
    i = 0
    k = 0
    do p = 1, size(partitions)
      associate (elements => partitions(p)%elements, nodes => partitions(p)%nodes)
        whole%elements(i + 1:i + size(elements)) = elements
        whole%nodes(k + 1:k + size(nodes)) = nodes
        i = i + size(elements)
        k = k + size(nodes)
      end associate
    end do
    whole%n_points = sum(partitions%n_points)
    whole%n_ids = sum(partitions%n_ids)
  end function join_partitions


  !> The first place of each number from 1 to n in a list; 0: it is not there.
  pure function first_places(list, n) result(place)
    integer, intent(in) :: list(:)
    integer, intent(in) :: n
    integer :: place(n)
    integer :: i
    place = 0
    do i = size(list), 1, -1
      place(list(i)) = i
    end do
  end function first_places


  !> The mesh of a partition as far as the result file shows it. Sets have those members that it has, a node of several
  !! partitions once.
  subroutine extract_mesh(mesh, partition, extract)
    type(mesh_type), intent(in) :: mesh
    type(partition_type), intent(in) :: partition
    type(mesh_type), intent(out) :: extract       !< its labels are those of the deck
    integer, allocatable :: of_node(:), of_element(:)
    integer :: i
    of_node = first_places(partition%nodes, mesh%n_nodes)
    of_element = first_places(partition%elements, mesh%n_elements)
    associate (elements => partition%elements, nodes => partition%nodes)
      extract%n_nodes = size(nodes)
      extract%n_elements = size(elements)
      extract%node_label = mesh%node_label(nodes)
      extract%coordinates = mesh%coordinates(:, nodes)
      extract%element_label = mesh%element_label(elements)
      extract%kind = mesh%kind(elements)
      extract%material = mesh%material(elements)
      extract%section = mesh%section(elements)
      extract%directions = mesh%directions(:, elements)
      extract%n_points = partition%n_points
      allocate (extract%first(size(elements) + 1), extract%point_first(size(elements) + 1), extract%nodes(partition%n_ids))
      extract%first(1) = 1
      extract%point_first(1) = 1
      do i = 1, size(elements)
        associate (connected => mesh%nodes(mesh%first(elements(i)):mesh%first(elements(i) + 1) - 1))
          extract%first(i + 1) = extract%first(i) + size(connected)
          extract%nodes(extract%first(i):extract%first(i + 1) - 1) = of_node(connected)
        end associate
        extract%point_first(i + 1) = extract%point_first(i) + mesh%point_first(elements(i) + 1) - mesh%point_first(elements(i))
      end do
    end associate
    if (allocated(mesh%node_sets)) call extract_sets(mesh%node_sets, of_node, extract%node_sets)
    if (allocated(mesh%element_sets)) call extract_sets(mesh%element_sets, of_element, extract%element_sets)
  end subroutine extract_mesh


  !> The sets with their members in another numbering.
  pure subroutine extract_sets(sets, place, extracts)
    type(set_type), intent(in) :: sets(:)
    integer, intent(in) :: place(:)               !< 0: not there
    type(set_type), allocatable, intent(out) :: extracts(:)
    integer :: i
    allocate (extracts(size(sets)))
    do i = 1, size(sets)
      extracts(i)%name = sets(i)%name
      extracts(i)%members = pack(place(sets(i)%members), place(sets(i)%members) > 0)
    end do
  end subroutine extract_sets


  !> Ending of the file of a partition, after the name of the job.
  pure function partition_ending(p) result(ending)
    integer, intent(in) :: p                      !< from 1
    character(24) :: ending
    write (ending, '(a, i4.4, a)') '.partition-', p, '.vtkhdf'
  end function partition_ending


  !> The rank, from 0, that writes a partition: the first of its group of ranks; of more partitions than ranks each rank writes
  !! several, one after the other.
  pure integer function writing_rank(p, n_partitions, n_ranks) result(rank)
    integer, intent(in) :: p                      !< from 1
    integer, intent(in) :: n_partitions, n_ranks
    rank = (p - 1) * n_ranks / n_partitions
  end function writing_rank

end module amontons_result_partitions
