!> Expanded: what CalculiX prints of axisymmetric elements, which it makes a solid sector of two degrees of the circle,
!! and of the plane elements beside them, of whose thickness it takes the same part.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Volumes and energies are those of the sector, a 180th of the circle. Forces are sums of the forces in space on the
!! nodes that one node became: what the hoop stress does to a node points, on both sides of the sector, across the radius
!! and cancels but for its turn by one degree, which these sums leave to the equations between the nodes. So the
!! radial force is that of the radial and shear stresses alone.
!!
!! Trusses become bars of 8 points, of 27 with a middle node, whose tensors stand in global axes.
module amontons_expanded
  use amontons_kinds, only: DP, PI
  use amontons_mesh, only: mesh_type, element_nodes, is_out
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_shapes, only: shape_functions, quadrature
  use amontons_state, only: fields_type
  use amontons_tensor, only: determinant_minus_one, unpack_voigt
  use amontons_topology, only: element_kind, FAMILY_AXISYMMETRIC, KIND_CAX4R, KIND_CPE4_FULL, KIND_T3D2, KIND_T3D3, &
    MAX_NODES, MAX_POINTS
  implicit none
  private
  public :: sector_share, take_sector, turn_trusses, bar_points

  real(DP), parameter :: SECTORS = 180             !< of two degrees in the circle

contains

  !> The part of an element that CalculiX has in its sector: 1 but in models of its dialect with axisymmetric elements.
  pure real(DP) function sector_share(model) result(share)
    type(model_type), intent(in) :: model
    integer :: e
    share = 1
    if (model%dialect /= DIALECT_CALCULIX) return
    do e = 1, model%mesh%n_elements
      if (is_axisymmetric(model%mesh, e)) share = 1 / SECTORS
      if (share < 1) return
    end do
  end function sector_share


  !> The points of the solid that a truss becomes, 0 of other elements: its tables have so many rows, all with the mean of
  !! its points.
  pure integer function bar_points(model, e) result(n)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e                       !< element
    n = 0
    if (model%dialect /= DIALECT_CALCULIX) return
    if (model%mesh%kind(e) == KIND_T3D2) n = 8
    if (model%mesh%kind(e) == KIND_T3D3) n = 27
  end function bar_points


  !> Tensors at the points, those of trusses turned from their axis into global axes where CalculiX has them so.
  pure function turn_trusses(model, fields, is_current, values) result(turned)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: is_current              !< along the truss as it lies now
    real(DP), intent(in) :: values(:, :)           !< (6, n_points) of trusses: xx along them
    real(DP) :: turned(6, size(values, 2))
    real(DP) :: chord(3)
    integer :: e, p, n, nodes(MAX_NODES)
    turned = values
    if (model%dialect /= DIALECT_CALCULIX) return
    do e = 1, model%mesh%n_elements
      if (.not. is_truss(model%mesh, e)) cycle
      call element_nodes(model%mesh, e, n, nodes)
      chord = model%mesh%coordinates(:, nodes(2)) - model%mesh%coordinates(:, nodes(1))
      if (is_current) chord = chord + fields%u(:, nodes(2)) - fields%u(:, nodes(1))
      chord = chord / norm2(chord)
      do p = model%mesh%point_first(e), model%mesh%point_first(e + 1) - 1
        associate (along => values(1, p), across => values(2, p))
          turned(:3, p) = across + (along - across) * chord**2
          turned(4:, p) = (along - across) * [chord(1) * chord(2), chord(2) * chord(3), chord(1) * chord(3)]
        end associate
      end do
    end do
  end function turn_trusses


  !> Whether an element is a truss.
  pure logical function is_truss(mesh, e)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e
    is_truss = mesh%kind(e) == KIND_T3D2 .or. mesh%kind(e) == KIND_T3D3
  end function is_truss


  !> Turns the forces of the full circle on the nodes of axisymmetric elements into those that CalculiX prints.
  pure subroutine take_sector(mesh, fields, is_nlgeom, force)
    type(mesh_type), intent(in) :: mesh
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: is_nlgeom
    real(DP), intent(inout) :: force(:, :)         !< (3, n_nodes) [force]
    logical :: has_circle
    real(DP) :: hoop(MAX_NODES)
    integer :: e, a, n, nodes(MAX_NODES)
    has_circle = .false.
    do e = 1, mesh%n_elements
      if (.not. is_axisymmetric(mesh, e) .or. is_out(mesh, e)) cycle
      call element_nodes(mesh, e, n, nodes)
      has_circle = .true.
      call hoop_forces(mesh, e, fields, is_nlgeom, hoop)
      do a = 1, n
        force(1, nodes(a)) = force(1, nodes(a)) - hoop(a)
      end do
    end do
    if (has_circle) force = force / SECTORS
  end subroutine take_sector


  !> Whether an element is axisymmetric.
  pure logical function is_axisymmetric(mesh, e)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e
    is_axisymmetric = .false.
    if (mesh%kind(e) > 0) is_axisymmetric = family_of(mesh%kind(e)) == FAMILY_AXISYMMETRIC
  end function is_axisymmetric


  !> The family of a kind.
  pure integer function family_of(kind) result(family)
    integer, intent(in) :: kind
    associate (entry => element_kind(kind))
      family = entry%family
    end associate
  end function family_of


  !> The radial forces of the hoop stress on the nodes of an element: sum of N_a/x tau V. Of finite strain Kirchhoff's
  !! stress comes from Cauchy's and from Green's strain, which the calculix dialect keeps.
  pure subroutine hoop_forces(mesh, e, fields, is_nlgeom, hoop)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: hoop(MAX_NODES)       !< [force]
    real(DP) :: xi(3, MAX_POINTS), w(MAX_POINTS), N(MAX_NODES), dN(3, MAX_NODES), share(MAX_POINTS)
    real(DP) :: J(2, 2), X(2, MAX_NODES), tau, stretch
    integer :: rule, p, q, m, n_rule, n_nodes, nodes(MAX_NODES)
    call element_nodes(mesh, e, n_nodes, nodes)
    X(:, :n_nodes) = mesh%coordinates(:2, nodes(:n_nodes))
    rule = mesh%kind(e)
    if (rule == KIND_CAX4R) rule = KIND_CPE4_FULL  ! one point, but the mean over four
    call quadrature(rule, n_rule, xi, w)
    m = mesh%point_first(e + 1) - mesh%point_first(e)
    hoop = 0
    do p = 1, n_rule
      call shape_functions(rule, xi(:, p), N, dN)
      J = matmul(X(:, :n_nodes), transpose(dN(:2, :n_nodes)))
      share(p) = w(p) * (J(1, 1) * J(2, 2) - J(1, 2) * J(2, 1)) * 2 * PI   ! volume over the radius
      q = mesh%point_first(e) + min(p, m) - 1
      tau = fields%stress(3, q)
      stretch = 1
      if (is_nlgeom) then
        stretch = sqrt(1 + 2 * fields%strain(3, q))
        tau = tau * sqrt(1 + determinant_minus_one(2 * unpack_voigt(fields%strain(:, q))))
      end if
      hoop(:n_nodes) = hoop(:n_nodes) + share(p) * tau / stretch * N(:n_nodes)
    end do
  end subroutine hoop_forces

end module amontons_expanded
