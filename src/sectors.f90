!> Sectors: cyclic symmetry: the nodes of one side of a sector move as those of the other side, turned by the angle of the sector.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_sectors
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, set_error, EXIT_SETUP
  use amontons_topology, only: MAX_FACE_NODES
  use amontons_loads, only: equation_type
  use amontons_ties, only: tie_type
  use amontons_model, only: model_type
  use amontons_shapes, only: facet_shapes
  use amontons_facets, only: facets_type, build_facets, facet_nodes
  use amontons_search, only: search_type, build_search
  use amontons_gap, only: projection_type, find_projection, PROJECT_ON
  implicit none
  private
  public :: join_sectors

  real(DP), parameter :: TOLERANCE = 1.0e-3_DP     !< without POSITION TOLERANCE: of the extent of the dependent side [-]

contains

  !> Appends u_s = R sum N_i u_i for every node s of the dependent side, R the turn that brings the independent side onto it.
  !!
  !! Of the two senses the one counts in which more nodes find a partner. Errors: nodes without a partner (EXIT_SETUP).
  subroutine join_sectors(model, tie, error)
    type(model_type), intent(inout) :: model
    type(tie_type), intent(in) :: tie
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: first(:), nodes(:), best_first(:), best_nodes(:)
    real(DP), allocatable :: weight(:), best_weight(:)
    real(DP) :: turn(3, 3), best_turn(3, 3)
    integer :: sense, s, k, n_found, n_best
    character(12) :: number
    n_best = -1
    do sense = 1, 2
      turn = tie%turn
      if (sense == 2) turn = transpose(tie%turn)
      call find_partners(model, tie, turn, first, nodes, weight, error)
      if (allocated(error)) return
      n_found = count(first(2:) > first(:size(first) - 1))
      if (n_found <= n_best) cycle
      n_best = n_found
      best_turn = turn
      best_first = first
      best_nodes = nodes
      best_weight = weight
    end do
    associate (slaves => model%surfaces(tie%slave)%nodes)
      if (n_best < size(slaves)) then
        write (number, '(i0)') size(slaves) - n_best
        call set_error(error, EXIT_SETUP, 'Of the dependent side of the cyclic symmetry ' // tie%name // ' ' // trim(number) // &
          ' nodes have no partner on the other side, turned by the angle of the sector. Look at N, the axis and POSITION ' // &
          'TOLERANCE.')
        return
      end if
      do s = 1, size(slaves)
        do k = 1, 3
          call add_row(model, slaves(s), k, best_nodes(best_first(s):best_first(s + 1) - 1), &
            best_weight(best_first(s):best_first(s + 1) - 1), best_turn(k, :), tie%line)
        end do
      end do
    end associate
  end subroutine join_sectors


  !> For each node of the dependent side the nodes and weights of its place on the independent side; none if there is none.
  subroutine find_partners(model, tie, turn, first, nodes, weight, error)
    type(model_type), intent(in) :: model
    type(tie_type), intent(in) :: tie
    real(DP), intent(in) :: turn(3, 3)             !< brings the independent side onto the dependent one
    integer, allocatable, intent(out) :: first(:)  !< (n + 1)
    integer, allocatable, intent(out) :: nodes(:)
    real(DP), allocatable, intent(out) :: weight(:)
    type(error_type), allocatable, intent(out) :: error
    type(facets_type) :: facets
    type(search_type) :: search
    real(DP) :: place(3), reach
    integer :: s, i
    logical :: has_faces
    associate (slaves => model%surfaces(tie%slave)%nodes, master => model%surfaces(tie%master), X => model%mesh%coordinates)
      allocate (first(size(slaves) + 1), source=1)
      allocate (nodes(0), weight(0))
      reach = tie%tolerance
      if (reach < 0.0_DP) reach = TOLERANCE * norm2(maxval(X(:, slaves), dim=2) - minval(X(:, slaves), dim=2))
      has_faces = .not. master%is_node_based
      if (has_faces) call build_facets(model%mesh, master%element, master%face, facets, error)
      if (allocated(error)) return
      if (has_faces) call build_search(facets, X, reach, search)
      do s = 1, size(slaves)
        place = tie%centre + matmul(transpose(turn), X(:, slaves(s)) - tie%centre)
        i = minloc(sum((X(:, master%nodes) - spread(place, 2, size(master%nodes)))**2, dim=1), dim=1)
        if (norm2(X(:, master%nodes(i)) - place) <= reach) then
          nodes = [nodes, master%nodes(i)]
          weight = [weight, 1.0_DP]
        else if (has_faces) then
          call take_facet(facets, search, X, place, reach, nodes, weight)
        end if
        first(s + 1) = size(nodes) + 1
      end do
    end associate
  end subroutine find_partners


  !> Appends the nodes of the facet at a place, if there is one within reach.
  subroutine take_facet(facets, search, X, place, reach, nodes, weight)
    type(facets_type), intent(in) :: facets
    type(search_type), intent(in) :: search
    real(DP), intent(in) :: X(:, :), place(3), reach   !< [length]
    integer, allocatable, intent(inout) :: nodes(:)
    real(DP), allocatable, intent(inout) :: weight(:)
    type(projection_type) :: projection
    real(DP) :: N_i(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    integer :: corners(MAX_FACE_NODES), n
    call find_projection(facets, search, X, place, reach, projection)
    if (projection%status /= PROJECT_ON .or. projection%facet == 0) return
    call facet_nodes(facets, projection%facet, n, corners)
    call facet_shapes(facets%kind(projection%facet), projection%xi, N_i, dN, ddN)
    nodes = [nodes, corners(:n)]
    weight = [weight, N_i(:n)]
  end subroutine take_facet


  !> u_s(k) - sum_j R(k, j) sum_i N_i u_i(j) = 0; terms of a node on the axis, which is its own partner, are added up.
  subroutine add_row(model, slave, k, partners, weight, turn, line)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: slave, k
    integer, intent(in) :: partners(:)
    real(DP), intent(in) :: weight(:), turn(3)     !< row k of R
    integer, intent(in) :: line                    !< of the deck
    type(equation_type) :: equation
    real(DP) :: coefficient
    integer :: i, j, n
    n = 3 * size(partners) + 3
    equation%node = [spread(slave, 1, 3), [(spread(partners(i), 1, 3), i=1, size(partners))]]
    equation%dof = [k, mod(k, 3) + 1, mod(k + 1, 3) + 1, [(1, 2, 3, i=1, size(partners))]]
    equation%coefficient = [1.0_DP, 0.0_DP, 0.0_DP, [((-weight(i) * turn(j), j=1, 3), i=1, size(partners))]]
    do i = 4, n
      if (equation%node(i) /= slave) cycle
      coefficient = equation%coefficient(i)
      equation%coefficient(i) = 0
      do j = 1, 3
        if (equation%dof(j) == equation%dof(i)) equation%coefficient(j) = equation%coefficient(j) + coefficient
      end do
    end do
    associate (is_kept => abs(equation%coefficient) > 1.0e-14_DP)
      if (.not. any(is_kept)) return               ! along the axis a node on it is free
      equation%node = pack(equation%node, is_kept)
      equation%dof = pack(equation%dof, is_kept)
      equation%coefficient = pack(equation%coefficient, is_kept)
    end associate
    equation%n_candidates = count(equation%node == slave)
    equation%card = 'CYCLIC SYMMETRY'
    equation%line = line
    model%equations = [model%equations, equation]
  end subroutine add_row

end module amontons_sectors
