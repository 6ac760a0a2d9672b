!> Embedded elements to equations: their nodes move with the points of the hosts where they lie.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!!     u(node) = sum N_a(xi) u_a
!!
!! with the shape functions of the host at the node, in each direction. The equations hold at finite displacements, too. They tie
!! displacements only: beams and shells turn freely about their nodes.
module amontons_embedded_elements
  use amontons_kinds, only: DP
  use amontons_element_kinds, only: element_kind_type, element_kind, FAMILY_SOLID
  use amontons_embeddings, only: embedding_type
  use amontons_errors, only: error_type, set_error, EXIT_SETUP
  use amontons_loads, only: equation_type, equation_list_type
  use amontons_mesh_point_search, only: located_point_type, locate_points, mean_element_size, &
    select_elements, exterior_limit
  use amontons_model, only: model_type
  use amontons_text, only: to_text, plural, verb
  implicit none
  private
  public :: embed_elements

  real(DP), parameter :: TOL_OUTSIDE = 1.0e-3_DP     !< nodes farther outside are listed, over the mean size of the hosts [-]

  !> The hosts of one card, as the search takes them.
  type :: hosts_type
    integer, allocatable :: kind(:)                  !< (hosts)
    integer, allocatable :: first(:)                 !< (hosts + 1)
    integer, allocatable :: nodes(:)
    integer :: n_dims = 3                            !< 2: they are plane or axisymmetric
  end type hosts_type

contains

  !> The equations of all cards. Errors: EXIT_SETUP (nodes outside).
  subroutine embed_elements(model, equations, text, error)
    type(model_type), intent(in) :: model            !< with embeddings
    type(equation_type), allocatable, intent(out) :: equations(:)
    character(:), allocatable, intent(out) :: text   !< of nodes a little outside; empty: there are none
    type(error_type), allocatable, intent(out) :: error
    type(equation_list_type) :: list
    type(hosts_type) :: hosts
    type(located_point_type), allocatable :: located(:)
    integer, allocatable :: nodes(:)
    integer :: k, i
    text = ''
    do k = 1, size(model%embeddings)
      call gather_hosts(model, model%embeddings(k), hosts)
      call list_embedded_nodes(model, model%embeddings(k), hosts, nodes)
      call locate_points(hosts%kind, hosts%first, hosts%nodes, model%mesh%coordinates, model%mesh%coordinates(:, nodes), located)
      call check_distances(model, model%embeddings(k), hosts, nodes, located, text, error)
      if (allocated(error)) return
      do i = 1, size(nodes)
        call add_equations(model%embeddings(k), nodes(i), located(i), hosts%n_dims, list)
      end do
    end do
    call list%move_to(equations)
  end subroutine embed_elements


  !> The hosts one after the other.
  subroutine gather_hosts(model, embedding, hosts)
    type(model_type), intent(in) :: model
    type(embedding_type), intent(in) :: embedding
    type(hosts_type), intent(out) :: hosts
    type(element_kind_type) :: kind
    integer :: i
    call select_elements(model%mesh%kind, model%mesh%first, model%mesh%nodes, embedding%hosts, hosts%kind, hosts%first, hosts%nodes)
    hosts%n_dims = 2
    do i = 1, size(hosts%kind)
      kind = element_kind(hosts%kind(i))
      if (kind%family == FAMILY_SOLID) hosts%n_dims = 3
    end do
  end subroutine gather_hosts


  !> The nodes of embedded elements as the deck has them, ascending, without those that hosts share.
  subroutine list_embedded_nodes(model, embedding, hosts, nodes)
    type(model_type), intent(in) :: model
    type(embedding_type), intent(in) :: embedding
    type(hosts_type), intent(in) :: hosts
    integer, allocatable, intent(out) :: nodes(:)
    logical :: is_wanted(model%mesh%n_nodes), is_structural
    integer :: i
    is_wanted = .false.
    do i = 1, size(embedding%elements)
      associate (e => embedding%elements(i))
        is_structural = .false.
        if (allocated(model%structure)) is_structural = model%structure%section(e) > 0
        if (is_structural) then
          is_wanted(model%structure%nodes(model%structure%first(e):model%structure%first(e + 1) - 1)) = .true.
        else
          is_wanted(model%mesh%nodes(model%mesh%first(e):model%mesh%first(e + 1) - 1)) = .true.
        end if
      end associate
    end do
    is_wanted(hosts%nodes) = .false.
    nodes = pack([(i, i=1, model%mesh%n_nodes)], is_wanted)
  end subroutine list_embedded_nodes


  !> Nodes beyond the tolerances are an error; others outside are listed.
  subroutine check_distances(model, embedding, hosts, nodes, located, text, error)
    type(model_type), intent(in) :: model
    type(embedding_type), intent(in) :: embedding
    type(hosts_type), intent(in) :: hosts
    integer, intent(in) :: nodes(:)
    type(located_point_type), intent(in) :: located(:)    !< (nodes)
    character(:), allocatable, intent(inout) :: text
    type(error_type), allocatable, intent(inout) :: error
    character(:), allocatable :: where
    real(DP) :: mean, largest                        ! size of a host, distance outside [length]
    integer :: farthest, n
    if (size(nodes) == 0) return
    mean = mean_element_size(hosts%first, hosts%nodes, model%mesh%coordinates)
    largest = exterior_limit(embedding%exterior_tolerance, embedding%absolute_tolerance, mean)
    farthest = maxloc(located%distance, dim=1)
    where = '; the farthest, node ' // to_text(model%mesh%node_label(nodes(farthest))) // ', is ' // &
      to_text(located(farthest)%distance) // ' away from the nearest host.'
    n = count(located%distance > largest)
    if (n > 0) then
      call set_error(error, EXIT_SETUP, '*EMBEDDED ELEMENT of line ' // to_text(embedding%line) // ': ' // plural(n, 'node') // &
        ' of the embedded elements ' // verb(n, 'lies', 'lie') // ' outside the hosts by more than ' // to_text(largest) // &
        where // ' EXTERIOR TOLERANCE (over the mean size of the hosts) and ABSOLUTE EXTERIOR TOLERANCE allow more.')
      return
    end if
    n = count(located%distance > TOL_OUTSIDE * mean)
    if (n > 0) text = text // '*EMBEDDED ELEMENT of line ' // to_text(embedding%line) // ': ' // plural(n, 'node') // &
      verb(n, ' moves', ' move') // ' with the nearest point of the hosts, outside of which ' // verb(n, 'it lies', 'they lie') // &
      where // ' '
  end subroutine check_distances


  !> The equations of a node.
  subroutine add_equations(embedding, node, located, n_dims, list)
    type(embedding_type), intent(in) :: embedding
    integer, intent(in) :: node, n_dims
    type(located_point_type), intent(in) :: located
    type(equation_list_type), intent(inout) :: list
    type(equation_type) :: equation
    integer, allocatable :: kept(:)
    integer :: i
    associate (weights => located%weights(:located%n_nodes))
      kept = pack([(i, i=1, located%n_nodes)], abs(weights) > embedding%roundoff_tolerance)
      do i = 1, n_dims
        equation%node = [node, located%nodes(kept)]
        equation%dof = spread(i, 1, size(kept) + 1)
        equation%coefficient = [1.0_DP, -weights(kept) / sum(weights(kept))]
        equation%card = 'EMBEDDED ELEMENT'
        equation%line = embedding%line
        equation%deck_dof = i
        call list%add(equation)
      end do
    end associate
  end subroutine add_equations

end module amontons_embedded_elements
