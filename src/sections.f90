!> Sections: force and moment that the stress carries through a surface of element faces, with its area and centre.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! As CalculiX takes them: the stress is extrapolated to the nodes, averaged there, and integrated over the faces, at
!! finite displacements over their present place. It follows that the force equals that of the loads only as well as the
!! mesh resolves the stress.
module amontons_sections
  use amontons_kinds, only: DP
  use amontons_tensor, only: cross_product, unpack_voigt
  use amontons_topology, only: element_kind, kind_type, FAMILY_SOLID, MAX_FACE_NODES
  use amontons_mesh, only: mesh_type
  use amontons_surfaces, only: surface_type
  use amontons_shapes, only: face_rule, facet_shapes, facet_quadrature, MAX_FACET_POINTS
  use amontons_state, only: fields_type
  use amontons_nodal, only: average_at_nodes
  implicit none
  private
  public :: section_type, measure_section

  !> The sums over a surface.
  type :: section_type
    real(DP) :: force(3) = 0                       !< on the body that the faces belong to [force]
    real(DP) :: moment(3) = 0                      !< about the origin [force length]
    real(DP) :: center(3) = 0                      !< of the area [length]
    real(DP) :: normal(3) = 0                      !< mean over the area, out of the body: shorter than 1 if it is bent
    real(DP) :: area = 0                           !< [length^2]
  end type section_type

contains

  !> The sums over a surface of element faces.
  subroutine measure_section(mesh, surface, fields, is_nlgeom, is_calculix, section)
    type(mesh_type), intent(in) :: mesh
    type(surface_type), intent(in) :: surface      !< of element faces
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: is_nlgeom               !< the faces are where they are now
    logical, intent(in) :: is_calculix             !< stress is brought to the nodes as CalculiX does
    type(section_type), intent(out) :: section
    real(DP) :: stress(6, mesh%n_nodes)
    integer :: i
    call average_at_nodes(mesh, fields%stress, stress, is_calculix)
    do i = 1, size(surface%element)
      call add_face(mesh, surface%element(i), surface%face(i), fields, stress, is_nlgeom, section)
    end do
    if (.not. section%area > 0) return
    section%center = section%center / section%area
    section%normal = section%normal / section%area
  end subroutine measure_section


  !> Adds one face. A plane body has edges for faces, as deep as it is thick, about its own plane.
  subroutine add_face(mesh, e, face, fields, stress, is_nlgeom, section)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e, face
    type(fields_type), intent(in) :: fields
    real(DP), intent(in) :: stress(:, :)           !< (6, n_nodes) [stress]
    logical, intent(in) :: is_nlgeom
    type(section_type), intent(inout) :: section
    type(kind_type) :: kind
    integer :: nodes(MAX_FACE_NODES), n, n_points, p
    real(DP) :: x(3, MAX_FACE_NODES), xi(2, MAX_FACET_POINTS), w(MAX_FACET_POINTS), at(3), along(3, 2), a(3), f(3)
    real(DP) :: shape(MAX_FACE_NODES), slope(2, MAX_FACE_NODES), bend(3, MAX_FACE_NODES)
    kind = element_kind(mesh%kind(e))
    n = count(kind%face_nodes(:, face) > 0)
    nodes(:n) = mesh%nodes(mesh%first(e) - 1 + kind%face_nodes(:n, face))
    x(:, :n) = mesh%coordinates(:, nodes(:n))
    if (is_nlgeom) x(:, :n) = x(:, :n) + fields%u(:, nodes(:n))
    call facet_quadrature(face_rule(mesh%kind(e), kind%face_kind(face), .true.), n_points, xi, w)
    do p = 1, n_points
      call facet_shapes(kind%face_kind(face), xi(:, p), shape, slope, bend)
      at = matmul(x(:, :n), shape(:n))
      along = matmul(x(:, :n), transpose(slope(:, :n)))
      if (kind%family /= FAMILY_SOLID) along(:, 2) = [0.0_DP, 0.0_DP, mesh%section(e)]
      a = w(p) * cross_product(along(:, 1), along(:, 2))
      f = matmul(unpack_voigt(matmul(stress(:, nodes(:n)), shape(:n))), a)
      section%force = section%force + f
      section%moment = section%moment + cross_product(at, f)
      section%center = section%center + norm2(a) * at
      section%normal = section%normal + a
      section%area = section%area + norm2(a)
    end do
  end subroutine add_face

end module amontons_sections
