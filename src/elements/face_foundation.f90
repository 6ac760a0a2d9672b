!> FOUNDATION: springs to the ground on faces of elements, normal to them.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A face with the normal n and the displacement u has the traction -k (u . n) n per area. With a = x,1 x x,2, whose length is the
!! area over that of the parametric square, nodal forces are f_b = -k int N_b g, g = (u . a) a/|a|. Under NLGEOM a is that of the
!! current face: the foundation turns with it. The derivative then has the part of a, which is not symmetric:
!! dg = a (a . du)/|a| + (a u' + (u . a)(1 - a a'/|a|^2))/|a| da. Edges of plane elements have a = depth (y', -x').
!! Theory: doc/theory/elements.md.
module amontons_face_foundation
  use amontons_kinds, only: DP, PI
  use amontons_shape_functions, only: facet_quadrature, facet_shapes, MAX_FACET_POINTS
  use amontons_element_kinds, only: MAX_FACE_NODES
  use amontons_tensor, only: IDENTITY, cross_product, skew_matrix
  implicit none
  private
  public :: integrate_face_foundation, integrate_edge_foundation

contains

  !> Nodal forces of the foundation of a face in space, and their derivative.
  pure subroutine integrate_face_foundation(facet_kind, X, u, k, is_nlgeom, force, stiffness)
    integer, intent(in) :: facet_kind              !< FACET_...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements [length]
    real(DP), intent(in) :: k                      !< [force/length^3]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_FACE_NODES)   !< zero past the nodes [force]
    real(DP), intent(out) :: stiffness(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES)   !< d force/d u, zero past 3 * nodes
    real(DP) :: xi(2, MAX_FACET_POINTS), w(MAX_FACET_POINTS), N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    real(DP) :: place(3, MAX_FACE_NODES), along(3, 2), turn(3, 3, MAX_FACE_NODES)
    integer :: m, n_rule, p, b
    m = size(X, 2)
    force = 0
    stiffness = 0
    place(:, :m) = X
    if (is_nlgeom) place(:, :m) = X + u
    call facet_quadrature(facet_kind, n_rule, xi, w)
    do p = 1, n_rule
      call facet_shapes(facet_kind, xi(:, p), N, dN, ddN)
      along = matmul(place(:, :m), transpose(dN(:, :m)))
      turn = 0
      if (is_nlgeom) then
        do b = 1, m                                ! da over the displacement of a node
          turn(:, :, b) = transpose(skew_matrix(dN(1, b) * along(:, 2) - dN(2, b) * along(:, 1)))
        end do
      end if
      call add_point(k * w(p), N(:m), cross_product(along(:, 1), along(:, 2)), turn(:, :, :m), u, force, stiffness)
    end do
  end subroutine integrate_face_foundation


  !> The same for an edge of a plane or axisymmetric element.
  pure subroutine integrate_edge_foundation(edge, X, u, width, k, is_nlgeom, force, stiffness)
    integer, intent(in) :: edge                    !< FACET_LINE2, FACET_LINE3
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements [length]
    real(DP), intent(in) :: width                  !< of the face [length], below zero: around the circle
    real(DP), intent(in) :: k                      !< [force/length^3]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_FACE_NODES)   !< zero past the nodes [force]
    real(DP), intent(out) :: stiffness(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES)   !< d force/d u, zero past 3 * nodes
    real(DP) :: xi(2, MAX_FACET_POINTS), w(MAX_FACET_POINTS), N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    real(DP) :: place(3, MAX_FACE_NODES), along(2), normal(3), depth, turn(3, 3, MAX_FACE_NODES)
    integer :: m, n_rule, p, b
    m = size(X, 2)
    force = 0
    stiffness = 0
    place(:, :m) = X
    if (is_nlgeom) place(:, :m) = X + u
    call facet_quadrature(edge, n_rule, xi, w)
    do p = 1, n_rule
      call facet_shapes(edge, xi(:, p), N, dN, ddN)
      along = matmul(place(:2, :m), dN(1, :m))
      normal = [along(2), -along(1), 0.0_DP]
      depth = width
      if (width < 0) depth = 2 * PI * dot_product(place(1, :m), N(:m))
      turn = 0
      if (is_nlgeom) then
        do b = 1, m
          turn(1, 2, b) = depth * dN(1, b)
          turn(2, 1, b) = -depth * dN(1, b)
          if (width < 0) turn(:, 1, b) = turn(:, 1, b) + 2 * PI * N(b) * normal
        end do
      end if
      call add_point(k * w(p), N(:m), depth * normal, turn(:, :, :m), u, force, stiffness)
    end do
  end subroutine integrate_edge_foundation


  !> Adds a point of the integral.
  pure subroutine add_point(factor, N, a, turn, u, force, stiffness)
    real(DP), intent(in) :: factor                 !< k times the weight of the point
    real(DP), intent(in) :: N(:)                   !< (nodes) shape functions [-]
    real(DP), intent(in) :: a(3)                   !< [length^2]
    real(DP), intent(in) :: turn(:, :, :)          !< (3, 3, nodes) da over the displacements of the nodes [length]
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements [length]
    real(DP), intent(inout) :: force(:, :), stiffness(:, :)
    real(DP) :: here(3), area, along, over_u(3, 3), over_a(3, 3), block(3, 3)
    integer :: b, c
    area = norm2(a)
    if (.not. area > 0) return                     ! a node on the axis
    here = matmul(u, N)
    along = dot_product(here, a)
    over_u = spread(a, 2, 3) * spread(a, 1, 3) / area
    over_a = (spread(a, 2, 3) * spread(here, 1, 3) + along * (IDENTITY - over_u / area)) / area
    do c = 1, size(N)
      block = -factor * (N(c) * over_u + matmul(over_a, turn(:, :, c)))
      force(:, c) = force(:, c) - factor * N(c) * (along / area) * a
      do b = 1, size(N)
        stiffness(3 * b - 2:3 * b, 3 * c - 2:3 * c) = stiffness(3 * b - 2:3 * b, 3 * c - 2:3 * c) + N(b) * block
      end do
    end do
  end subroutine add_point

end module amontons_face_foundation
