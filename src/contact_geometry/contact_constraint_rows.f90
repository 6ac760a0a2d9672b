!> Contact constraint rows: relative position of a slave node as a weighted sum of nodal positions, with its force distribution.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A row is a relative position d and the corresponding force:
!!
!!     d = sum w_k x_k,    F_k = w_k lambda,    Rhat_row = sum b_k Rhat_k
!!
!! with weights that are positive at the slave and negative at the master, sum w_k = 0. In node-to-surface contact the weights come
!! from one facet (1 at the slave node, -N_i at the facet), in mortar contact from inv(D) M (doc/theory/contact.md, section 7). The
!! contact force lambda is minus the imbalance of the row, Rhat_row, as far as the contact laws admit it. No other data of a contact
!! formulation enters the contact evaluation.
module amontons_contact_constraint_rows
  use amontons_kinds, only: DP
  use amontons_element_kinds, only: MAX_FACE_NODES
  use amontons_shape_functions, only: facet_shapes
  use amontons_facets, only: facets_type
  use amontons_analytic_master, only: evaluate_profile_weights
  implicit none
  private
  public :: contact_row_type, fill_facet_row, evaluate_facet_weights, evaluate_relative_position, evaluate_row_imbalance, &
    distribute_row_force

  !> One row; the slave node itself comes first.
  type :: contact_row_type
    integer, allocatable :: nodes(:)               !< (n) mesh nodes, each once
    real(DP), allocatable :: weights(:)            !< (n) w_k [-]
    integer, allocatable :: imbalance_nodes(:)                 !< (m) slave nodes whose imbalances form that of the row
    real(DP), allocatable :: imbalance_weights(:)             !< (m) b_k [-]
  end type contact_row_type

contains

  !> The row of a node against a point of one facet: 1 at the node, -N_i at the facet's nodes.
  pure subroutine fill_facet_row(facets, f, xi, node, row)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f                       !< facet
    real(DP), intent(in) :: xi(2)                  !< natural coordinates [-]
    integer, intent(in) :: node                    !< slave node
    type(contact_row_type), intent(inout) :: row
    real(DP) :: weights(MAX_FACE_NODES), d_weights(2, MAX_FACE_NODES)
    integer :: n, nodes(MAX_FACE_NODES)
    call evaluate_facet_weights(facets, f, xi, n, nodes, weights, d_weights)
    row%nodes = [node, nodes(:n)]
    row%weights = [1.0_DP, -weights(:n)]
    row%imbalance_nodes = [node]
    row%imbalance_weights = [1.0_DP]
  end subroutine fill_facet_row


  !> Nodes of a facet and their weights N_i at a point of it.
  pure subroutine evaluate_facet_weights(facets, f, xi, n, nodes, weights, d_weights)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f                       !< facet
    real(DP), intent(in) :: xi(2)                  !< natural coordinates [-]
    integer, intent(out) :: n                      !< number of its nodes
    integer, intent(out) :: nodes(MAX_FACE_NODES)
    real(DP), intent(out) :: weights(MAX_FACE_NODES)        !< N_i [-]
    real(DP), intent(out) :: d_weights(2, MAX_FACE_NODES)   !< dN_i/dxi [-]
    real(DP) :: ddN(3, MAX_FACE_NODES)
    if (allocated(facets%profile)) then            ! its derivatives come from amontons_surface_projection
      d_weights = 0.0_DP
      call evaluate_profile_weights(facets, f, xi, n, nodes, weights)
      return
    end if
    n = facets%first(f + 1) - facets%first(f)
    nodes(:n) = facets%nodes(facets%first(f):facets%first(f + 1) - 1)
    call facet_shapes(facets%kind(f), xi, weights, d_weights, ddN)
  end subroutine evaluate_facet_weights


  !> d = sum w_k x_k, for positions or any other nodal vector field.
  pure function evaluate_relative_position(row, x, u) result(d)
    type(contact_row_type), intent(in) :: row
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    real(DP), intent(in), optional :: u(:, :)      !< (3, n_nodes) displacements of x [length]
    real(DP) :: d(3)
    integer :: i
    d = 0.0_DP
    do i = 1, size(row%nodes)
      d = d + row%weights(i) * x(:, row%nodes(i))
      if (present(u)) d = d + row%weights(i) * u(:, row%nodes(i))
    end do
  end function evaluate_relative_position


  !> Rhat_row = sum b_k Rhat_k.
  pure function evaluate_row_imbalance(row, imbalance) result(total)
    type(contact_row_type), intent(in) :: row
    real(DP), intent(in) :: imbalance(:, :)        !< (3, n_nodes) Rhat, condensed [force]
    real(DP) :: total(3)
    integer :: i
    total = 0.0_DP
    do i = 1, size(row%imbalance_nodes)
      total = total + row%imbalance_weights(i) * imbalance(:, row%imbalance_nodes(i))
    end do
  end function evaluate_row_imbalance


  !> Adds w_k lambda to the forces of the nodes.
  pure subroutine distribute_row_force(row, lambda, force)
    type(contact_row_type), intent(in) :: row
    real(DP), intent(in) :: lambda(3)              !< [force]
    real(DP), intent(inout) :: force(:, :)         !< (3, n_nodes) [force]
    integer :: i
    do i = 1, size(row%nodes)
      force(:, row%nodes(i)) = force(:, row%nodes(i)) + row%weights(i) * lambda
    end do
  end subroutine distribute_row_force

end module amontons_contact_constraint_rows
