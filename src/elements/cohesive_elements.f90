!> Cohesive elements: two faces of equal shape that hold each other by tractions over their separation.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! At each pair of nodes, one of either face, there is a point. It has the separation of the pair in the frame of the middle surface
!! between both faces, and the area that consistent forces of a uniform pressure give this node. The tractions t(s) of the law give
!!
!!     F = sum of A (ds/du)' t,   K = sum of A ((ds/du)' (dt/ds) ds/du + t d2s/du2),
!!
!! so that forces and moments of both faces balance. Under small displacements ds/du is that of the reference configuration. Points
!! at the nodes keep the tractions of a stiff law from oscillating along the element: J. C. J. Schellekens, R. de Borst, Int. J.
!! Numer. Meth. Engng 36 (1993) 43-66. Tractions are per reference area. Theory: doc/theory/cohesion.md.
module amontons_cohesive_elements
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use amontons_kinds, only: DP, PI
  use amontons_element_integration_points, only: integration_points_type, TOL_SYMMETRIC, ELEMENT_OK, &
    ELEMENT_INVERTED, ELEMENT_NOT_FINITE, &
    ELEMENT_DEGENERATE
  use amontons_element_kinds, only: element_kind, element_kind_type, opposite_node, KIND_COH2D4, KIND_COHAX4, KIND_COH3D6, &
    MAX_ELEMENT_NODES, MAX_FACE_NODES
  use amontons_face_separation, only: separation_type, evaluate_separation, N_VARIABLES
  use amontons_materials, only: material_type
  use amontons_membrane_elements, only: set_surface_axes
  use amontons_shape_functions, only: facet_shapes, facet_quadrature, facet_node_coordinates, MAX_FACET_POINTS
  use amontons_tensor, only: cross_product
  use amontons_traction_separation, only: cohesive_point_type, evaluate_cohesive_law, N_COHESIVE_STATE
  implicit none
  private
  public :: evaluate_cohesive_element, evaluate_cohesive_volumes, integrate_cohesive_body_force, set_cohesive_temperature_weights

  integer, parameter :: MAX_PAIRS = 4            !< most pairs of nodes

  !> A point in the reference configuration.
  type :: reference_type
    real(DP) :: frame(3, 3) = 0                    !< e1, e2, normal in columns
    real(DP) :: slope(MAX_PAIRS, 2) = 0            !< derivatives of the shape functions along e1, e2 [1/length]
  end type reference_type

contains

  !> Internal force, point values and, if requested, the tangent of a cohesive element, which need not be symmetric.
  pure subroutine evaluate_cohesive_element(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    integer, intent(in) :: kind                    !< KIND_COH...
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)   !< [force]
    type(integration_points_type), intent(inout) :: points     !< in: section, the past; out: the point values
    integer, intent(out) :: status                 !< ELEMENT_...
    real(DP), intent(out), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< d force/d u [force/length]
    type(reference_type) :: reference
    type(separation_type) :: separation
    type(cohesive_point_type) :: point
    real(DP) :: share(3, size(X, 2)), direction(3)
    integer :: n, p
    n = size(X, 2)
    force = 0
    if (present(stiffness)) stiffness(:3 * n, :3 * n) = 0
    status = ELEMENT_NOT_FINITE
    if (.not. all(ieee_is_finite(u(:, :n)))) return
    call evaluate_cohesive_volumes(kind, X, points%section_value, p, points%volume, status)
    if (status /= ELEMENT_OK) return
    do p = 1, n / 2
      direction = [1.0_DP, 0.0_DP, 0.0_DP]
      if (points%has_frame) direction = points%frame(:, 1, p)
      call set_reference(kind, X, p, direction, reference, status)
      if (status /= ELEMENT_OK) return
      call set_shares(kind, p, reference, share)
      call find_separation(X, u, is_nlgeom, reference, share, separation, status)
      if (status /= ELEMENT_OK) return
      call set_law_input(kind, material, points, p, n, point)
      point%separation = separation%value
      if (is_flat(kind)) point%separation(3) = 0
      call evaluate_cohesive_law(material, point)
      call store_output(kind, points, p, point)
      call add_forces(points%volume(p) / point%thickness, is_nlgeom, point, separation, share, force, stiffness)
    end do
    if (is_flat(kind)) then
      force(3, :) = 0
      if (present(stiffness)) then
        stiffness(3:3 * n:3, :3 * n) = 0
        stiffness(:3 * n, 3:3 * n:3) = 0
      end if
    end if
    if (present(stiffness) .and. material%is_unsymmetric) call mark_unsymmetric(3 * n, stiffness, points)
    if (all(ieee_is_finite(force))) return
    status = ELEMENT_NOT_FINITE
  end subroutine evaluate_cohesive_element


  !> Frame of a point, and the derivatives of the shape functions of its face along the first two axes. In space the first axis is
  !! the projection of a direction, or of z where that is the normal; in the plane it is along the element.
  pure subroutine set_reference(kind, X, p, direction, reference, status)
    integer, intent(in) :: kind
    real(DP), intent(in) :: X(:, :)
    integer, intent(in) :: p                       !< point: pair of nodes
    real(DP), intent(in) :: direction(3)
    type(reference_type), intent(out) :: reference
    integer, intent(out) :: status                 !< ELEMENT_OK or ELEMENT_DEGENERATE
    real(DP) :: along(3, 2), dN(2, MAX_FACE_NODES), first(3), area
    integer :: m
    m = size(X, 2) / 2
    call set_tangents(kind, X, p, dN, along)
    first = direction
    if (is_flat(kind)) first = along(:, 1) / max(norm2(along(:, 1)), tiny(area))
    call set_surface_axes(along, dN(:, :m), first, reference%frame, reference%slope(:m, :), area, status)
  end subroutine set_reference


  !> Tangents of the middle surface at a pair of nodes by its natural coordinates; in the plane the second is -z.
  pure subroutine set_tangents(kind, X, p, dN, along)
    integer, intent(in) :: kind
    real(DP), intent(in) :: X(:, :)
    integer, intent(in) :: p
    real(DP), intent(out) :: dN(2, MAX_FACE_NODES)
    real(DP), intent(out) :: along(3, 2)           !< [length]
    real(DP) :: xi(2, MAX_FACE_NODES)
    type(element_kind_type) :: entry
    entry = element_kind(kind)
    call facet_node_coordinates(entry%face_kind(1), xi)
    call set_tangents_at(kind, X, xi(:, p), dN, along)
  end subroutine set_tangents


  !> The same anywhere.
  pure subroutine set_tangents_at(kind, X, xi, dN, along)
    integer, intent(in) :: kind
    real(DP), intent(in) :: X(:, :)
    real(DP), intent(in) :: xi(2)
    real(DP), intent(out) :: dN(2, MAX_FACE_NODES)
    real(DP), intent(out) :: along(3, 2)           !< [length]
    real(DP) :: N(MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    type(element_kind_type) :: entry
    integer :: a
    entry = element_kind(kind)
    call facet_shapes(entry%face_kind(1), xi, N, dN, ddN)
    along = 0
    do a = 1, entry%n_points
      associate (middle => 0.5_DP * (X(:, a) + X(:, opposite_node(kind, a))))
        along(:, 1) = along(:, 1) + middle * dN(1, a)
        along(:, 2) = along(:, 2) + middle * dN(2, a)
      end associate
    end do
    if (is_flat(kind)) along(:, 2) = [0.0_DP, 0.0_DP, -1.0_DP]
  end subroutine set_tangents_at


  !> Whether a kind lies in the plane.
  pure logical function is_flat(kind)
    integer, intent(in) :: kind
    is_flat = kind == KIND_COH2D4 .or. kind == KIND_COHAX4
  end function is_flat


  !> Factors of the displacement of each node in f1, f2 and the vector between the faces.
  pure subroutine set_shares(kind, p, reference, share)
    integer, intent(in) :: kind, p
    type(reference_type), intent(in) :: reference
    real(DP), intent(out) :: share(:, :)           !< (3, nodes)
    integer :: a, opposite
    do a = 1, size(share, 2) / 2
      opposite = opposite_node(kind, a)
      share(:2, a) = 0.5_DP * reference%slope(a, :)
      share(:2, opposite) = share(:2, a)
      share(3, a) = merge(-1.0_DP, 0.0_DP, a == p)
      share(3, opposite) = -share(3, a)
    end do
  end subroutine set_shares


  !> Separation of a point less that of the reference configuration, and its derivatives.
  pure subroutine find_separation(X, u, is_nlgeom, reference, share, separation, status)
    real(DP), intent(in) :: X(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    type(reference_type), intent(in) :: reference
    real(DP), intent(in) :: share(:, :)
    type(separation_type), intent(out) :: separation
    integer, intent(out) :: status                 !< ELEMENT_OK or ELEMENT_INVERTED
    type(separation_type) :: at_rest
    real(DP) :: change(3, 3), gap(3)
    status = ELEMENT_OK
    gap = matmul(X, share(3, :))
    change = matmul(u, transpose(share))
    at_rest = evaluate_separation(reference%frame(:, 1), reference%frame(:, 2), gap)
    if (.not. is_nlgeom) then
      separation = at_rest
      separation%value = matmul(reshape(change, [N_VARIABLES]), at_rest%slope)
      separation%curvature = 0
      return
    end if
    associate (f1 => reference%frame(:, 1) + change(:, 1), f2 => reference%frame(:, 2) + change(:, 2))
      if (.not. norm2(cross_product(f1, f2)) > 0) then
        status = ELEMENT_INVERTED
        return
      end if
      separation = evaluate_separation(f1, f2, gap + change(:, 3))
    end associate
    separation%value = separation%value - at_rest%value
  end subroutine find_separation


  !> What the law needs beside the separation.
  pure subroutine set_law_input(kind, material, points, p, n, point)
    integer, intent(in) :: kind
    type(material_type), intent(in) :: material
    type(integration_points_type), intent(in) :: points
    integer, intent(in) :: p, n                    !< point, nodes
    type(cohesive_point_type), intent(out) :: point
    real(DP) :: weight(MAX_ELEMENT_NODES, MAX_PAIRS)
    point%thickness = points%cohesive(1)
    point%viscosity = points%cohesive(2)
    if (allocated(material%damage)) point%viscosity = max(point%viscosity, material%damage%viscosity)
    point%time_increment = points%elapsed_time
    weight = 0
    call set_cohesive_temperature_weights(kind, weight)
    point%argument = dot_product(weight(:n, p), points%temperature(:n))
    if (material%table_variable > 0) point%argument = dot_product(weight(:n, p), points%field(:n))
    if (allocated(points%inner_old)) point%state_old = points%inner_old(:N_COHESIVE_STATE, p)
  end subroutine set_law_input


  !> Stress and strain of a point: the normal one is 33 in space, 22 in the plane; shears 13, 23 and 12.
  pure subroutine store_output(kind, points, p, point)
    integer, intent(in) :: kind
    type(integration_points_type), intent(inout) :: points
    integer, intent(in) :: p
    type(cohesive_point_type), intent(in) :: point
    integer, parameter :: IN_SPACE(3) = [3, 6, 5], IN_PLANE(2) = [2, 4]
    points%stress(:, p) = 0
    points%strain(:, p) = 0
    associate (strain => [1.0_DP, 0.5_DP, 0.5_DP] * point%separation / point%thickness)
      if (is_flat(kind)) then
        points%stress(IN_PLANE, p) = point%traction(:2)
        points%strain(IN_PLANE, p) = strain(:2)
      else
        points%stress(IN_SPACE, p) = point%traction
        points%strain(IN_SPACE, p) = strain
      end if
    end associate
    points%energy(p) = point%energy
    points%history(:, p) = points%history_old(:, p)
    if (allocated(points%inner)) points%inner(:N_COHESIVE_STATE, p) = point%state
  end subroutine store_output


  !> Adds forces and stiffness of a point.
  pure subroutine add_forces(area, is_nlgeom, point, separation, share, force, stiffness)
    real(DP), intent(in) :: area                   !< [length^2]
    logical, intent(in) :: is_nlgeom
    type(cohesive_point_type), intent(in) :: point
    type(separation_type), intent(in) :: separation
    real(DP), intent(in) :: share(:, :)
    real(DP), intent(inout) :: force(3, MAX_ELEMENT_NODES)
    real(DP), intent(inout), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    real(DP) :: A(N_VARIABLES, N_VARIABLES), g(3, 3), block(3, 3)
    integer :: i, j, m, n
    g = area * reshape(matmul(separation%slope, point%traction), [3, 3])
    do n = 1, size(share, 2)
      force(:, n) = force(:, n) + matmul(g, share(:, n))
    end do
    if (.not. present(stiffness)) return
    A = matmul(separation%slope, matmul(point%tangent, transpose(separation%slope)))
    if (is_nlgeom) then
      do i = 1, 3
        A = A + point%traction(i) * separation%curvature(:, :, i)
      end do
    end if
    A = area * A
    do n = 1, size(share, 2)
      do m = 1, size(share, 2)
        block = 0
        do j = 1, 3
          do i = 1, 3
            block = block + share(i, m) * share(j, n) * A(3 * i - 2:3 * i, 3 * j - 2:3 * j)
          end do
        end do
        associate (place => stiffness(3 * m - 2:3 * m, 3 * n - 2:3 * n))
          place = place + block
        end associate
      end do
    end do
  end subroutine add_forces


  !> Lets the caller take a stiffness that is not symmetric beyond rounding as it is; else symmetric to the last bit.
  pure subroutine mark_unsymmetric(n, stiffness, points)
    integer, intent(in) :: n                       !< rows
    real(DP), intent(inout) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    type(integration_points_type), intent(inout) :: points
    associate (K => stiffness(:n, :n))
      if (all(abs(K - transpose(K)) <= TOL_SYMMETRIC * maxval(abs(K)))) then
        K = 0.5_DP * (K + transpose(K))
      else if (.not. allocated(points%skew)) then
        allocate (points%skew(0, 0, 0))
      end if
    end associate
  end subroutine mark_unsymmetric


  !> Volume of each point: the area of its pair of nodes times the constitutive thickness; of bodies of
  !! revolution around the circle.
  pure subroutine evaluate_cohesive_volumes(kind, X, section, n, volumes, status)
    integer, intent(in) :: kind                    !< KIND_COH...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) coordinates [length]
    real(DP), intent(in) :: section                !< thickness, in the plane times the width [length] or [length^2]
    integer, intent(out) :: n                      !< points
    real(DP), intent(inout) :: volumes(:)          !< the first n are set [length^3]
    integer, intent(out) :: status                 !< ELEMENT_OK or ELEMENT_DEGENERATE
    real(DP) :: xi(2, MAX_FACET_POINTS), w(MAX_FACET_POINTS), N_a(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES), &
      along(3, 2), depth
    type(element_kind_type) :: entry
    integer :: q, m, a
    entry = element_kind(kind)
    n = entry%n_points
    volumes(:n) = 0
    call facet_quadrature(entry%face_kind(1), m, xi, w)
    do q = 1, m
      call set_tangents_at(kind, X, xi(:, q), dN, along)
      call facet_shapes(entry%face_kind(1), xi(:, q), N_a, dN, ddN)
      depth = section
      if (kind == KIND_COHAX4) depth = PI * section * sum([(N_a(a) * (X(1, a) + X(1, opposite_node(kind, a))), a=1, n)])
      volumes(:n) = volumes(:n) + w(q) * depth * norm2(cross_product(along(:, 1), along(:, 2))) * N_a(:n)
    end do
    status = merge(ELEMENT_OK, ELEMENT_DEGENERATE, all(volumes(:n) > 0))
  end subroutine evaluate_cohesive_volumes


  !> Consistent nodal forces of a body force on a cohesive element.
  pure subroutine integrate_cohesive_body_force(kind, X, section, b, force)
    integer, intent(in) :: kind                    !< KIND_COH...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: section                !< as of evaluate_cohesive_volumes
    real(DP), intent(in) :: b(3)                   !< [force/length^3]
    real(DP), intent(inout) :: force(3, MAX_ELEMENT_NODES)   !< in: zero [force]
    real(DP) :: volumes(MAX_PAIRS)
    integer :: n, a, status
    call evaluate_cohesive_volumes(kind, X, section, n, volumes, status)
    do a = 1, n
      force(:, a) = 0.5_DP * volumes(a) * b
      force(:, opposite_node(kind, a)) = force(:, a)
    end do
  end subroutine integrate_cohesive_body_force


  !> Weights of the nodal temperatures: the mean of the pair of each point.
  pure subroutine set_cohesive_temperature_weights(kind, weight)
    integer, intent(in) :: kind                    !< KIND_COH...
    real(DP), intent(inout) :: weight(:, :)        !< (MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS), zero [-]
    type(element_kind_type) :: entry
    integer :: p
    entry = element_kind(kind)
    do p = 1, entry%n_points
      weight([p, opposite_node(kind, p)], p) = 0.5_DP
    end do
  end subroutine set_cohesive_temperature_weights

end module amontons_cohesive_elements
