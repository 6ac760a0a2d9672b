!> Analytic: masters that are profiles: their facets are the pieces, carried by a few nodes of a rigid body.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, "Analytic masters". The carriers stand at A_0, A_0 + h e_1, A_0 + h e_2 (in space also
!! + h e_3). Every point of the body is an affine combination of them, x = sum w_i(X) x_i, or x = A X + b with the
!! rotation A. A slave node is taken back to where the profile is undeformed, X = inv(A) (x_s - b), projected there, and
!! foot and normal come back with A. A is a rotation only when the body's bond has converged: with the length l = |A N| all
!! derivatives hold before that too,
!!
!!     n = A N/l,  g = l G,  x_s = x_m + g n,   dX = inv(A) (dx_s - sum w_i(X) dx_i),   dG = N . dX
!!     d(A N) = sum (grad w_i . N) dx_i + A Q dX,   dn = (1 - n n') d(A N)/l,   dg = l dG + G n . d(A N),
!!     dw_i = grad w_i . P dX,   P = sum c_a t_a t_a',  Q = sum q_a t_a t_a'   (`profiles`)
!!
!! What is found of a point, projection_type and gap_derivative_type, is said alike by profiles and by facets (`gap`).
module amontons_analytic_master
  use amontons_kinds, only: DP
  use amontons_tensor, only: outer, invert, IDENTITY
  use amontons_topology, only: FACET_LINE2, FACET_QUAD4, MAX_FACE_NODES
  use amontons_facets, only: facets_type
  use amontons_analytic_profiles, only: profile_type, place_type, find_place, place_at, point_of, PROFILE_FLAT
  implicit none
  private
  public :: build_profile_facets, project_on_profile, find_on_profile, profile_derivative, profile_weights, &
    carrier_weights, bending_at
  public :: projection_type, gap_derivative_type
  public :: PROJECT_ON, PROJECT_OFF, PROJECT_FAILED

  real(DP), parameter :: EXTENSION = 0.1_DP    !< a node this far beyond an end or a corner is on, over the slave's edge [-]

  integer, parameter :: PROJECT_ON = 0       !< the point is on a facet (or in its extension zone)
  integer, parameter :: PROJECT_OFF = 1      !< the point is beyond a free edge or a crease that sticks out
  integer, parameter :: PROJECT_FAILED = 2   !< no projection found: too far from the facet, or too strongly bent

  !> Where a point is on a surface.
  type :: projection_type
    integer :: status = PROJECT_FAILED       !< PROJECT_...
    integer :: facet = 0                     !< 0: none
    real(DP) :: xi(2) = 0                    !< natural coordinates [-]
    real(DP) :: gap = 0                      !< signed distance along the normal, negative is penetration [length]
    real(DP) :: normal(3) = 0                !< unit normal out of the master [-]
  end type projection_type

  !> Exact first derivatives of projection, gap and normal by the slave node and by all nodes of the facet's stencil.
  !! The nodes that carry weight, those of the facet, come first.
  type :: gap_derivative_type
    integer :: n_nodes = 0                       !< nodes of the stencil
    integer :: n_weights = 0                     !< of them, those of the facet
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
  end type gap_derivative_type

contains

  !> The pieces of a profile as facets.
  pure subroutine build_profile_facets(profile, edge, facets)
    type(profile_type), intent(in) :: profile    !< with carriers
    real(DP), intent(in) :: edge                 !< of the faces that it meets [length]
    type(facets_type), intent(out) :: facets
    integer :: k, n
    n = profile%n_carriers
    facets%profile = profile
    facets%n = profile%n
    allocate (facets%kind(profile%n), source=merge(FACET_LINE2, FACET_QUAD4, profile%kind == PROFILE_FLAT))
    facets%first = [(n * (k - 1) + 1, k=1, profile%n + 1)]
    facets%nodes = [(profile%carriers(:n), k=1, profile%n)]
    allocate (facets%element(profile%n), facets%face(profile%n), source=0)
    allocate (facets%neighbour(4, profile%n), facets%edge(4, profile%n), source=0)
    allocate (facets%edge_length(profile%n), source=edge)
  end subroutine build_profile_facets


  !> Follows a point from a piece to where it is now; OFF beyond an end or a corner.
  pure subroutine project_on_profile(facets, x, point, f, projection)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    real(DP), intent(in) :: point(3)             !< x_s [length]
    integer, intent(in) :: f                     !< piece
    type(projection_type), intent(out) :: projection
    call project(facets, x, point, f, huge(1.0_DP), projection)
  end subroutine project_on_profile


  !> The projection of a point that has none yet; behind the surface not deeper than a distance.
  pure subroutine find_on_profile(facets, x, point, deepest, projection)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    real(DP), intent(in) :: point(3)             !< x_s [length]
    real(DP), intent(in) :: deepest              !< [length]
    type(projection_type), intent(out) :: projection
    call project(facets, x, point, 0, deepest, projection)
  end subroutine find_on_profile


  !> Both.
  pure subroutine project(facets, x, point, f, deepest, projection)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :), point(3)    !< [length]
    integer, intent(in) :: f
    real(DP), intent(in) :: deepest              !< [length]
    type(projection_type), intent(out) :: projection
    type(place_type) :: place
    real(DP) :: A(3, 3), inverse(3, 3), det, normal(3)
    logical :: is_on
    associate (profile => facets%profile)
      A = motion(profile, x)
      call invert(A, inverse, det)
      call find_place(profile, profile%anchor + matmul(inverse, point - x(:, profile%carriers(1))), &
        EXTENSION * facets%edge_length(1), deepest, f, place, is_on)
      projection%status = merge(PROJECT_ON, PROJECT_OFF, is_on)
      if (place%piece == 0) return
      normal = matmul(A, place%normal)
      projection%facet = place%piece
      projection%xi = place%xi
      projection%gap = norm2(normal) * place%gap
      projection%normal = normal / norm2(normal)
    end associate
  end subroutine project


  !> A, from where the carriers are.
  pure function motion(profile, x) result(A)
    type(profile_type), intent(in) :: profile
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) [length]
    real(DP) :: A(3, 3)
    integer :: k
    A = IDENTITY
    do k = 1, profile%n_carriers - 1
      A(:, k) = (x(:, profile%carriers(k + 1)) - x(:, profile%carriers(1))) / profile%span
    end do
  end function motion


  !> w_i(X), the weights of the carriers at an undeformed point.
  pure function carrier_weights(profile, X) result(weights)
    type(profile_type), intent(in) :: profile
    real(DP), intent(in) :: X(3)                 !< [length]
    real(DP) :: weights(4)                       !< [-]
    integer :: n
    n = profile%n_carriers
    weights = 0.0_DP
    weights(2:n) = (X(:n - 1) - profile%anchor(:n - 1)) / profile%span
    weights(1) = 1.0_DP - sum(weights(2:n))
  end function carrier_weights


  !> The weights of the carriers at a place of the surface.
  pure subroutine profile_weights(facets, f, xi, n, nodes, weights)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f                     !< piece
    real(DP), intent(in) :: xi(2)                !< natural coordinates of the piece [-]
    integer, intent(out) :: n                    !< number of carriers
    integer, intent(out) :: nodes(MAX_FACE_NODES)
    real(DP), intent(out) :: weights(MAX_FACE_NODES)   !< [-]
    real(DP) :: X(3), p(2), normal(2)
    n = facets%profile%n_carriers
    nodes = 0
    nodes(:n) = facets%profile%carriers(:n)
    call point_of(facets%profile, f, xi, X, p, normal)
    weights = 0.0_DP
    weights(:4) = carrier_weights(facets%profile, X)
  end subroutine profile_weights


  !> The exact derivatives of place, gap and normal. The two coordinates of the place are lengths along t_1 and t_2 here.
  pure subroutine profile_derivative(facets, x, f, xi, g, derivative)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    integer, intent(in) :: f                     !< piece
    real(DP), intent(in) :: xi(2)                !< natural coordinates of the piece [-]
    real(DP), intent(in) :: g                    !< gap [length]
    type(gap_derivative_type), intent(out) :: derivative
    type(place_type) :: place
    real(DP) :: A(3, 3), inverse(3, 3), det, length, gradient(3, 4), at_slave(4), turn(3, 3), by_point(3, 3)
    integer :: i, k, n
    associate (profile => facets%profile)
      n = profile%n_carriers
      A = motion(profile, x)
      call invert(A, inverse, det)
      place = place_at(profile, f, xi, 0.0_DP)
      derivative%n = matmul(A, place%normal)
      length = norm2(derivative%n)
      derivative%n = derivative%n / length
      place = place_at(profile, f, xi, g / length)
      derivative%n_nodes = n
      derivative%n_weights = n
      derivative%nodes = profile%carriers(:n)
      at_slave = carrier_weights(profile, place%foot)
      derivative%weights = at_slave(:n)
      at_slave = carrier_weights(profile, place%foot + place%gap * place%normal)
      gradient = 0.0_DP
      do k = 1, n - 1
        gradient(k, k + 1) = 1.0_DP / profile%span
        gradient(k, 1) = -1.0_DP / profile%span
      end do
    end associate
    derivative%d_weights = matmul(transpose(place%tangent), gradient(:, :n))
    derivative%d_xi_slave = spread(place%c, 2, 3) * matmul(transpose(place%tangent), inverse)
    turn = (IDENTITY - outer(derivative%n, derivative%n)) / length
    by_point = matmul(A, matmul(place%tangent * spread(place%q, 1, 3), matmul(transpose(place%tangent), inverse)))   ! A Q inv(A)
    derivative%d_n_slave = matmul(turn, by_point)
    derivative%d_gap_slave = length * matmul(place%normal, inverse) + place%gap * matmul(derivative%n, by_point)
    allocate (derivative%d_gap(3, n), derivative%d_xi(2, 3, n), derivative%d_n(3, 3, n))
    do i = 1, n
      associate (along => dot_product(gradient(:, i), place%normal))
        derivative%d_xi(:, :, i) = -at_slave(i) * derivative%d_xi_slave
        derivative%d_n(:, :, i) = along * turn - at_slave(i) * derivative%d_n_slave
        derivative%d_gap(:, i) = place%gap * along * derivative%n - at_slave(i) * derivative%d_gap_slave
      end associate
    end do
  end subroutine profile_derivative


  !> Two over the smaller radius of curvature at a place of the surface [1/length].
  pure real(DP) function bending_at(facets, f, xi) result(bending)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f                     !< piece
    real(DP), intent(in) :: xi(2)                !< natural coordinates of the piece [-]
    type(place_type) :: place
    place = place_at(facets%profile, f, xi, 0.0_DP)
    bending = 2.0_DP * maxval(abs(place%q))
  end function bending_at

end module amontons_analytic_master
