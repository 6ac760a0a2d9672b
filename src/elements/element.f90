!> Dispatcher over the element kinds: internal force, tangent, volume, body force, and pressure on facets.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory and symbols: doc/theory/elements.md. Kernels: `solid_elements` in three dimensions, `plane_elements` for plane and
!! axisymmetric elements, `membrane_elements` for membranes, `cohesive_elements` for layers of glue, `truss_spring_mass` for the
!! rest. The pressure on a facet is the same for all solids and membranes.
module amontons_element
  use amontons_kinds, only: DP
  use amontons_cohesive_elements, only: evaluate_cohesive_element, evaluate_cohesive_volumes, integrate_cohesive_body_force, &
    set_cohesive_temperature_weights
  use amontons_truss_spring_mass, only: evaluate_truss_element, evaluate_truss_volumes, integrate_truss_body_force, &
    evaluate_spring_element
  use amontons_materials, only: material_type
  use amontons_membrane_elements, only: evaluate_membrane_element, evaluate_membrane_volumes, integrate_membrane_body_force, &
    set_membrane_temperature_weights
  use amontons_plane_elements, only: evaluate_plane_element, evaluate_plane_volumes, integrate_plane_body_force, &
    set_plane_temperature_weights, integrate_edge_pressure
  use amontons_solid_elements, only: evaluate_solid_element, evaluate_solid_volumes, integrate_solid_body_force, &
    set_solid_temperature_weights
  use amontons_element_integration_points, only: integration_points_type, ELEMENT_OK, ELEMENT_INVERTED, ELEMENT_NOT_FINITE, &
    ELEMENT_DEGENERATE
  use amontons_shape_functions, only: facet_shapes, facet_quadrature, MAX_FACET_POINTS
  use amontons_tensor, only: cross_product, skew_matrix
  use amontons_element_kinds, only: facet_kind_type, kind_of_facet => facet_kind, MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS, &
    MAX_FACE_NODES, &
    KIND_CPS3, KIND_CAX_SHELL, KIND_M3D3, KIND_M3D8R, KIND_T3D2, KIND_T3D3, KIND_SPRINGA, KIND_GAPUNI, KIND_MASS, KIND_USER, &
    KIND_COH2D4, KIND_COH3D8, N_SOLID_KINDS
  implicit none
  private
  public :: integration_points_type, evaluate_element_forces, evaluate_element_tangent
  public :: evaluate_element_volume, evaluate_point_volumes, integrate_body_force, integrate_facet_pressure, integrate_edge_pressure
  public :: set_temperature_weights
  public :: ELEMENT_OK, ELEMENT_INVERTED, ELEMENT_NOT_FINITE, ELEMENT_DEGENERATE

contains

  !> Internal force, point values and, if requested, the tangent of an element: selects the kernel of each kind.
  pure subroutine evaluate_element_forces(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    integer, intent(in) :: kind                    !< KIND_...
    type(material_type), intent(in) :: material    !< springs and masses: not looked at
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements [length]
    logical, intent(in) :: is_nlgeom               !< .true.: finite displacements
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)   !< internal force, zero past the nodes [force]
    type(integration_points_type), intent(inout) :: points     !< in: the past; out: the point values
    integer, intent(out) :: status                 !< ELEMENT_...; if not ELEMENT_OK the other output is invalid
    real(DP), intent(out), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< d force/d u, symmetric (C3D8I:
                                                                                                 !! plus skew)
    select case (kind)
    case (KIND_CPS3:KIND_CAX_SHELL)
      call evaluate_plane_element(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    case (KIND_M3D3:KIND_M3D8R)
      call evaluate_membrane_element(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    case (KIND_T3D2, KIND_T3D3)
      call evaluate_truss_element(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    case (KIND_SPRINGA:KIND_GAPUNI)
      call evaluate_spring_element(kind, X, u, is_nlgeom, force, points, status, stiffness)
    case (KIND_COH2D4:KIND_COH3D8)
      call evaluate_cohesive_element(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    case (KIND_MASS:KIND_USER)                     ! no stiffness of their own, or one by the routine UEL
      force = 0
      status = ELEMENT_OK
      if (present(stiffness)) stiffness(:3 * size(X, 2), :3 * size(X, 2)) = 0
    case default
      call evaluate_solid_element(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    end select
  end subroutine evaluate_element_forces


  !> The tangent of an element alone.
  pure subroutine evaluate_element_tangent(kind, material, X, u, is_nlgeom, stiffness, points, status)
    integer, intent(in) :: kind                    !< KIND_...
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements [length]
    logical, intent(in) :: is_nlgeom               !< .true.: finite displacements
    real(DP), intent(out) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< d force/d u, symmetric (C3D8I: plus
                                                                                       !! skew), to 3 * nodes
    type(integration_points_type), intent(inout) :: points     !< in: the past; out: the point values
    integer, intent(out) :: status                 !< ELEMENT_...; if not ELEMENT_OK the other output is invalid
    real(DP) :: force(3, MAX_ELEMENT_NODES)
    call evaluate_element_forces(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
  end subroutine evaluate_element_tangent


  !> Volume of an element in given coordinates, and whether it is positive everywhere. Springs and masses have zero volume.
  pure subroutine evaluate_element_volume(kind, X, section, volume, status, walls)
    integer, intent(in) :: kind                    !< KIND_...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) coordinates [length]
    real(DP), intent(in) :: section                !< thickness [length] or cross-section [length^2]
    real(DP), intent(out) :: volume                !< [length^3]
    integer, intent(out) :: status                 !< ELEMENT_OK or ELEMENT_DEGENERATE
    real(DP), intent(in), optional :: walls(4)     !< of a hollow beam [-]
    real(DP) :: volumes(MAX_ELEMENT_POINTS)
    integer :: n
    call evaluate_point_volumes(kind, X, section, n, volumes, status, walls)
    volume = sum(volumes(:n))
  end subroutine evaluate_element_volume


  !> The volume of each integration point of an element.
  pure subroutine evaluate_point_volumes(kind, X, section, n, volumes, status, walls)
    integer, intent(in) :: kind                    !< KIND_...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) coordinates [length]
    real(DP), intent(in) :: section                !< thickness [length] or cross-section [length^2]
    integer, intent(out) :: n                      !< integration points
    real(DP), intent(out) :: volumes(:)            !< (MAX_ELEMENT_POINTS) zero past n [length^3]
    integer, intent(out) :: status                 !< ELEMENT_OK or ELEMENT_DEGENERATE
    real(DP), intent(in), optional :: walls(4)     !< of a hollow beam [-]
    volumes = 0
    select case (kind)
    case (KIND_CPS3:KIND_CAX_SHELL)
      call evaluate_plane_volumes(kind, X, section, n, volumes, status)
    case (KIND_M3D3:KIND_M3D8R)
      call evaluate_membrane_volumes(kind, X, section, n, volumes, status)
    case (KIND_T3D2, KIND_T3D3)
      call evaluate_truss_volumes(kind, X, section, n, volumes, status)
    case (KIND_SPRINGA)
      n = 0
      status = merge(ELEMENT_OK, ELEMENT_DEGENERATE, norm2(X(:, 2) - X(:, 1)) > 0)
    case (KIND_COH2D4:KIND_COH3D8)
      call evaluate_cohesive_volumes(kind, X, section, n, volumes, status)
    case (KIND_SPRINGA + 1:KIND_USER)
      n = 0
      status = ELEMENT_OK
    case default
      call evaluate_solid_volumes(kind, X, n, volumes, status, walls)
    end select
  end subroutine evaluate_point_volumes


  !> Consistent nodal forces of a body force: force_a = sum over points of N_a b w.
  pure subroutine integrate_body_force(kind, X, section, b, force, walls)
    integer, intent(in) :: kind                    !< KIND_...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: section                !< thickness [length], cross-section [length^2] or mass [mass]
    real(DP), intent(in) :: b(3)                   !< force per reference volume [force/length^3], or per mass [force/mass]
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)   !< zero past the nodes [force]
    real(DP), intent(in), optional :: walls(4)     !< of a hollow beam [-]
    force = 0
    select case (kind)
    case (KIND_CPS3:KIND_CAX_SHELL)
      call integrate_plane_body_force(kind, X, section, b, force)
    case (KIND_M3D3:KIND_M3D8R)
      call integrate_membrane_body_force(kind, X, section, b, force)
    case (KIND_T3D2, KIND_T3D3)
      call integrate_truss_body_force(kind, X, section, b, force)
    case (KIND_COH2D4:KIND_COH3D8)
      call integrate_cohesive_body_force(kind, X, section, b, force)
    case (KIND_MASS)
      force(:, 1) = section * b
    case (:N_SOLID_KINDS)
      call integrate_solid_body_force(kind, X, b, force, walls)
    case default                                   ! springs and rigid edges have no weight
    end select
  end subroutine integrate_body_force


  !> Weights of the nodal temperatures at the integration points of any kind; springs and masses have no points.
  pure subroutine set_temperature_weights(kind, weight, walls)
    integer, intent(in) :: kind                    !< KIND_...
    real(DP), intent(out) :: weight(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)   !< [-]
    real(DP), intent(in), optional :: walls(4)     !< of a hollow beam [-]
    weight = 0
    select case (kind)
    case (:N_SOLID_KINDS)
      call set_solid_temperature_weights(kind, weight, walls)
    case (KIND_CPS3:KIND_CAX_SHELL)
      call set_plane_temperature_weights(kind, weight)
    case (KIND_M3D3:KIND_M3D8R)
      call set_membrane_temperature_weights(kind, weight)
    case (KIND_T3D2, KIND_T3D3)
      weight(:2, :) = 0.5_DP
    case (KIND_COH2D4:KIND_COH3D8)
      call set_cohesive_temperature_weights(kind, weight)
    end select
  end subroutine set_temperature_weights


  !> Consistent nodal forces of a pressure on a facet in its current place, and their derivative, the load stiffness:
  !! force_a = -pressure * integral of N_a (dx/dxi1 x dx/dxi2).
  !! Positive pressure pushes against the normal of the right-hand rule. The derivative is not symmetric for an open
  !! surface. Reference: J. Bonet, R. D. Wood, Nonlinear continuum mechanics for finite element analysis, 2nd ed.,
  !! section 8.5.
  pure subroutine integrate_facet_pressure(facet_kind, x, pressure, force, stiffness, profile, rule)
    integer, intent(in) :: facet_kind              !< FACET_...
    real(DP), intent(in) :: x(:, :)                !< (3, nodes) current coordinates [length]
    real(DP), intent(in) :: pressure               !< [stress]
    real(DP), intent(out) :: force(3, MAX_FACE_NODES)   !< zero past the nodes [force]
    real(DP), intent(out) :: stiffness(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES)   !< d force/d x, zero past 3 * nodes
    real(DP), intent(in), optional :: profile(:)   !< factors of the pressure at the points of the facet; absent: 1 [-]
    integer, intent(in), optional :: rule          !< the facet kind whose quadrature is used; absent: its own
    type(facet_kind_type) :: facet
    real(DP) :: xi(2, MAX_FACET_POINTS), w(MAX_FACET_POINTS)
    real(DP) :: N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES), along(3, 2), turn_matrix(3, 3)
    integer :: n_rule, p, a, b
    facet = kind_of_facet(facet_kind)
    force = 0
    stiffness = 0
    if (present(rule)) then
      call facet_quadrature(rule, n_rule, xi, w)
    else
      call facet_quadrature(facet_kind, n_rule, xi, w)
    end if
    do p = 1, n_rule
      call facet_shapes(facet_kind, xi(:, p), N, dN, ddN)
      along = 0
      do a = 2, facet%n_nodes
        along(:, 1) = along(:, 1) + (x(:, a) - x(:, 1)) * dN(1, a)
        along(:, 2) = along(:, 2) + (x(:, a) - x(:, 1)) * dN(2, a)
      end do
      N = -pressure * w(p) * N
      if (present(profile)) N = profile(p) * N
      do b = 1, facet%n_nodes
        force(:, b) = force(:, b) + N(b) * cross_product(along(:, 1), along(:, 2))
        turn_matrix = transpose(skew_matrix(dN(1, b) * along(:, 2) - dN(2, b) * along(:, 1)))
        do a = 1, facet%n_nodes
          associate (block => stiffness(3 * a - 2:3 * a, 3 * b - 2:3 * b))
            block = block + N(a) * turn_matrix
          end associate
        end do
      end do
    end do
  end subroutine integrate_facet_pressure

end module amontons_element
