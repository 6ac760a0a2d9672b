!> Projection of slave nodes on analytic rigid surfaces, with exact derivatives.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, "Analytic masters". The facets are the pieces of a profile, which moves with a few carrier nodes
!! of a rigid body. The carriers are at A_0, A_0 + h e_1, A_0 + h e_2 (in space also + h e_3). Every point of the body is an affine
!! combination of them, x = sum w_i(X) x_i, or x = A X + b with the rotation A. The slave node maps to
!! X = inv(A) (x_s - b) on the undeformed side and is projected there; A maps projection and normal to the current configuration. A
!! is a rotation only after the rigid body constraint has converged: with the length l = |A N| all derivatives hold before that too,
!!
!!     n = A N/l,  g = l G,  x_s = x_m + g n,   dX = inv(A) (dx_s - sum w_i(X) dx_i),   dG = N . dX
!!     d(A N) = sum (grad w_i . N) dx_i + A Q dX,   dn = (1 - n n') d(A N)/l,   dg = l dG + G n . d(A N),
!!     dw_i = grad w_i . P dX,   P = sum c_a t_a t_a',  Q = sum q_a t_a t_a'   (amontons_analytic_profiles)
!!
!! projection_type and gap_derivatives_type hold the results of profiles and of facets (amontons_surface_projection) alike.
module amontons_analytic_master
  use amontons_kinds, only: DP
  use amontons_tensor, only: outer_product, invert, IDENTITY
  use amontons_element_kinds, only: FACET_LINE2, FACET_QUAD4, MAX_FACE_NODES
  use amontons_facets, only: facets_type
  use amontons_analytic_profiles, only: analytic_profile_type, profile_point_type, project_to_profile, evaluate_profile_point, &
    profile_coordinates, PROFILE_PLANAR
  implicit none
  private
  public :: build_profile_facets, project_on_profile, find_profile_projection, evaluate_profile_derivative, &
    evaluate_profile_weights, &
    evaluate_carrier_weights, evaluate_profile_bending
  public :: projection_type, gap_derivatives_type
  public :: PROJECTION_INSIDE, PROJECTION_OUTSIDE, PROJECTION_FAILED

  real(DP), parameter :: PROFILE_EXTENSION = 0.1_DP    !< extension zone beyond an end or a corner, over the slave's edge [-]

  integer, parameter :: PROJECTION_INSIDE = 0       !< the point is on a facet (or in its extension zone)
  integer, parameter :: PROJECTION_OUTSIDE = 1      !< the point is beyond a free edge or a crease that sticks out
  integer, parameter :: PROJECTION_FAILED = 2   !< no projection found: too far from the facet, or too strongly bent

  !> Projection of a point on a surface.
  type :: projection_type
    integer :: status = PROJECTION_FAILED       !< PROJECTION_...
    integer :: facet = 0                     !< 0: none
    real(DP) :: xi(2) = 0                    !< natural coordinates [-]
    real(DP) :: gap = 0                      !< signed distance along the normal, negative is penetration [length]
    real(DP) :: normal(3) = 0                !< unit normal out of the master [-]
  end type projection_type

  !> Exact first derivatives of projection, gap and normal with respect to the slave node and all nodes of the facet's stencil. The
  !! nodes with weights, those of the facet, come first.
  type :: gap_derivatives_type
    integer :: n_nodes = 0                       !< nodes of the stencil
    integer :: n_weights = 0                     !< those with weights: nodes of the facet
    integer, allocatable :: nodes(:)             !< (n_nodes) mesh nodes
    real(DP), allocatable :: weights(:)          !< (n_weights) N_i(xi) [-]
    real(DP), allocatable :: d_weights(:, :)     !< (2, n_weights) dN_i/dxi [-]
    real(DP) :: n(3) = 0                         !< unit normal [-]
    real(DP) :: d_gap_slave(3) = 0               !< dg/dx_s [-]
    real(DP), allocatable :: d_gap(:, :)         !< (3, n_nodes) dg/dx_j [-]
    real(DP) :: d_xi_slave(2, 3) = 0             !< dxi/dx_s [1/length]
    real(DP), allocatable :: d_xi(:, :, :)       !< (2, 3, n_nodes) dxi/dx_j [1/length]
    real(DP) :: d_n_slave(3, 3) = 0              !< dn/dx_s [1/length]
    real(DP), allocatable :: d_n(:, :, :)        !< (3, 3, n_nodes) dn/dx_j; first index: component of n [1/length]
  end type gap_derivatives_type

contains

  !> The pieces of a profile as facets.
  pure subroutine build_profile_facets(profile, edge, facets)
    type(analytic_profile_type), intent(in) :: profile    !< with carriers
    real(DP), intent(in) :: edge                 !< mean edge of the slave faces [length]
    type(facets_type), intent(out) :: facets
    integer :: k, n
    n = profile%n_carrier_nodes
    facets%profile = profile
    facets%n = profile%n
    allocate (facets%kind(profile%n), source=merge(FACET_LINE2, FACET_QUAD4, profile%kind == PROFILE_PLANAR))
    facets%first = [(n * (k - 1) + 1, k=1, profile%n + 1)]
    facets%nodes = [(profile%carriers(:n), k=1, profile%n)]
    allocate (facets%element(profile%n), facets%face(profile%n), source=0)
    allocate (facets%neighbour(4, profile%n), facets%edge(4, profile%n), source=0)
    allocate (facets%edge_length(profile%n), source=edge)
  end subroutine build_profile_facets


  !> Tracks the projection of a point from a piece to the current one; OUTSIDE beyond an end or a corner.
  pure subroutine project_on_profile(facets, x, point, f, projection)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    real(DP), intent(in) :: point(3)             !< x_s [length]
    integer, intent(in) :: f                     !< piece
    type(projection_type), intent(out) :: projection
    call project_point(facets, x, point, f, huge(1.0_DP), projection)
  end subroutine project_on_profile


  !> Finds the projection of a point without a previous one; penetrations beyond max_depth are ignored.
  pure subroutine find_profile_projection(facets, x, point, max_depth, projection)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    real(DP), intent(in) :: point(3)             !< x_s [length]
    real(DP), intent(in) :: max_depth              !< [length]
    type(projection_type), intent(out) :: projection
    call project_point(facets, x, point, 0, max_depth, projection)
  end subroutine find_profile_projection


  !> Common part of tracking and finding.
  pure subroutine project_point(facets, x, point, f, max_depth, projection)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :), point(3)    !< [length]
    integer, intent(in) :: f
    real(DP), intent(in) :: max_depth              !< [length]
    type(projection_type), intent(out) :: projection
    type(profile_point_type) :: profile_point
    real(DP) :: A(3, 3), inverse(3, 3), det, normal(3)
    logical :: is_on
    associate (profile => facets%profile)
      A = carrier_rotation(profile, x)
      call invert(A, inverse, det)
      call project_to_profile(profile, profile%anchor + matmul(inverse, point - x(:, profile%carriers(1))), &
        PROFILE_EXTENSION * facets%edge_length(1), max_depth, f, profile_point, is_on)
      projection%status = merge(PROJECTION_INSIDE, PROJECTION_OUTSIDE, is_on)
      if (profile_point%piece == 0) return
      normal = matmul(A, profile_point%normal)
      projection%facet = profile_point%piece
      projection%xi = profile_point%xi
      projection%gap = norm2(normal) * profile_point%gap
      projection%normal = normal / norm2(normal)
    end associate
  end subroutine project_point


  !> A, from the current coordinates of the carriers.
  pure function carrier_rotation(profile, x) result(A)
    type(analytic_profile_type), intent(in) :: profile
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) [length]
    real(DP) :: A(3, 3)
    integer :: k
    A = IDENTITY
    do k = 1, profile%n_carrier_nodes - 1
      A(:, k) = (x(:, profile%carriers(k + 1)) - x(:, profile%carriers(1))) / profile%span
    end do
  end function carrier_rotation


  !> w_i(X), the weights of the carriers at an undeformed point.
  pure function evaluate_carrier_weights(profile, X) result(weights)
    type(analytic_profile_type), intent(in) :: profile
    real(DP), intent(in) :: X(3)                 !< [length]
    real(DP) :: weights(4)                       !< [-]
    integer :: n
    n = profile%n_carrier_nodes
    weights = 0.0_DP
    weights(2:n) = (X(:n - 1) - profile%anchor(:n - 1)) / profile%span
    weights(1) = 1.0_DP - sum(weights(2:n))
  end function evaluate_carrier_weights


  !> Weights of the carriers at a point of the surface.
  pure subroutine evaluate_profile_weights(facets, f, xi, n, nodes, weights)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f                     !< piece
    real(DP), intent(in) :: xi(2)                !< natural coordinates of the piece [-]
    integer, intent(out) :: n                    !< number of carriers
    integer, intent(out) :: nodes(MAX_FACE_NODES)
    real(DP), intent(out) :: weights(MAX_FACE_NODES)   !< [-]
    real(DP) :: X(3), p(2), normal(2)
    n = facets%profile%n_carrier_nodes
    nodes = 0
    nodes(:n) = facets%profile%carriers(:n)
    call profile_coordinates(facets%profile, f, xi, X, p, normal)
    weights = 0.0_DP
    weights(:4) = evaluate_carrier_weights(facets%profile, X)
  end subroutine evaluate_profile_weights


  !> Exact derivatives of projection, gap and normal. The two surface coordinates are lengths along t_1 and t_2 here.
  pure subroutine evaluate_profile_derivative(facets, x, f, xi, g, derivative)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    integer, intent(in) :: f                     !< piece
    real(DP), intent(in) :: xi(2)                !< natural coordinates of the piece [-]
    real(DP), intent(in) :: g                    !< gap [length]
    type(gap_derivatives_type), intent(out) :: derivative
    type(profile_point_type) :: profile_point
    real(DP) :: A(3, 3), inverse(3, 3), det, length, gradient(3, 4), at_slave(4), normal_derivative(3, 3), by_point(3, 3)
    integer :: i, k, n
    associate (profile => facets%profile)
      n = profile%n_carrier_nodes
      A = carrier_rotation(profile, x)
      call invert(A, inverse, det)
      profile_point = evaluate_profile_point(profile, f, xi, 0.0_DP)
      derivative%n = matmul(A, profile_point%normal)
      length = norm2(derivative%n)
      derivative%n = derivative%n / length
      profile_point = evaluate_profile_point(profile, f, xi, g / length)
      derivative%n_nodes = n
      derivative%n_weights = n
      derivative%nodes = profile%carriers(:n)
      at_slave = evaluate_carrier_weights(profile, profile_point%closest_point)
      derivative%weights = at_slave(:n)
      at_slave = evaluate_carrier_weights(profile, profile_point%closest_point + profile_point%gap * profile_point%normal)
      gradient = 0.0_DP
      do k = 1, n - 1
        gradient(k, k + 1) = 1.0_DP / profile%span
        gradient(k, 1) = -1.0_DP / profile%span
      end do
    end associate
    derivative%d_weights = matmul(transpose(profile_point%tangent), gradient(:, :n))
    derivative%d_xi_slave = spread(profile_point%c, 2, 3) * matmul(transpose(profile_point%tangent), inverse)
    normal_derivative = (IDENTITY - outer_product(derivative%n, derivative%n)) / length
    ! A Q inv(A)
    by_point = matmul(A, matmul(profile_point%tangent * spread(profile_point%q, 1, 3), matmul(transpose(profile_point%tangent), &
      inverse)))
    derivative%d_n_slave = matmul(normal_derivative, by_point)
    derivative%d_gap_slave = length * matmul(profile_point%normal, inverse) + profile_point%gap * matmul(derivative%n, by_point)
    allocate (derivative%d_gap(3, n), derivative%d_xi(2, 3, n), derivative%d_n(3, 3, n))
    do i = 1, n
      associate (along => dot_product(gradient(:, i), profile_point%normal))
        derivative%d_xi(:, :, i) = -at_slave(i) * derivative%d_xi_slave
        derivative%d_n(:, :, i) = along * normal_derivative - at_slave(i) * derivative%d_n_slave
        derivative%d_gap(:, i) = profile_point%gap * along * derivative%n - at_slave(i) * derivative%d_gap_slave
      end associate
    end do
  end subroutine evaluate_profile_derivative


  !> Two over the smaller radius of curvature at a point of the surface [1/length].
  pure real(DP) function evaluate_profile_bending(facets, f, xi) result(bending)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f                     !< piece
    real(DP), intent(in) :: xi(2)                !< natural coordinates of the piece [-]
    type(profile_point_type) :: profile_point
    profile_point = evaluate_profile_point(facets%profile, f, xi, 0.0_DP)
    bending = 2.0_DP * maxval(abs(profile_point%q))
  end function evaluate_profile_bending

end module amontons_analytic_master
