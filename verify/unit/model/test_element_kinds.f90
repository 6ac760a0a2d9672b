!> Unit test of amontons_element_kinds: the tables of elements and faces against each other and against the shape functions.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_element_kinds
  use amontons_kinds, only: DP
  use amontons_shape_functions, only: node_coordinates
  use amontons_tensor, only: cross_product
  use amontons_element_kinds, only: element_kind, element_kind_type, facet_kind, facet_kind_type, element_kind_by_name, N_KINDS, &
    N_SOLID_KINDS, KIND_C3D8, KIND_C3D8_FULL, KIND_USER, KIND_CPE4, KIND_CAX4, KIND_CAX4_FULL, KIND_CPE4_FULL, FAMILY_SOLID, &
    MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS, MAX_FACE_NODES, FACET_TRI3, FACET_LINE3
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_entries()
  call check_names()
  call check_faces()
  call check_facets()
  call suite%finish()

contains

  !> No entry is larger than the arrays that it goes into; solids come first.
  subroutine check_entries()
    type(element_kind_type) :: entry
    integer :: kind, f
    do kind = 1, N_KINDS
      entry = element_kind(kind)
      call suite%that('a name', len_trim(entry%name) > 0)
      call suite%that(entry%name // ': fits', entry%n_nodes >= merge(0, 1, kind == KIND_USER) .and. &
        entry%n_nodes <= MAX_ELEMENT_NODES .and. entry%n_points <= MAX_ELEMENT_POINTS)
      call suite%that(entry%name // ': family', (entry%family == FAMILY_SOLID) .eqv. kind <= N_SOLID_KINDS)
      do f = 1, entry%n_faces
        associate (nodes => entry%face_nodes(:, f))
          call suite%that(entry%name // ': nodes of a face', maxval(nodes) <= entry%n_nodes &
            .and. count(nodes > 0) == n_of(entry%face_kind(f)))
        end associate
      end do
    end do
  end subroutine check_entries


  !> Nodes of a kind of facets.
  integer function n_of(kind)
    integer, intent(in) :: kind
    type(facet_kind_type) :: shape
    shape = facet_kind(kind)
    n_of = shape%n_nodes
  end function n_of


  !> Names lead back to their kinds; of two kinds of one name to the mean-dilatation one.
  subroutine check_names()
    type(element_kind_type) :: entry
    integer :: kind, found
    do kind = 1, N_KINDS
      entry = element_kind(kind)
      found = element_kind_by_name(trim(entry%name))
      if (kind == KIND_C3D8_FULL .or. kind == KIND_CPE4_FULL .or. kind == KIND_CAX4_FULL) cycle
      call suite%that(entry%name // ': by name', found == kind)
    end do
    call suite%that('mean dilatation', element_kind_by_name('C3D8') == KIND_C3D8 .and. element_kind_by_name('CPE4') == KIND_CPE4 &
      .and. element_kind_by_name('CAX4') == KIND_CAX4)
    entry = element_kind(KIND_C3D8_FULL)
    call suite%that('the full one has none', .not. entry%is_mean_dilatation)
    call suite%that('no such element', element_kind_by_name('C3D9') == 0 .and. element_kind_by_name('') == 0)
  end subroutine check_names


  !> Faces of solids look outward, and mid-side nodes lie between their corners.
  subroutine check_faces()
    type(element_kind_type) :: entry
    type(facet_kind_type) :: shape
    real(DP) :: xi(3, MAX_ELEMENT_NODES), middle(3), normal(3), centre(3)
    integer :: kind, f, k, m
    do kind = 1, N_SOLID_KINDS
      entry = element_kind(kind)
      call node_coordinates(kind, xi)
      centre = sum(xi(:, :entry%n_nodes), 2) / real(entry%n_nodes, DP)
      do f = 1, entry%n_faces
        shape = facet_kind(entry%face_kind(f))
        m = shape%n_corners
        associate (nodes => entry%face_nodes(:, f))
          normal = cross_product(xi(:, nodes(2)) - xi(:, nodes(1)), xi(:, nodes(m)) - xi(:, nodes(1)))
          middle = sum(xi(:, nodes(:m)), 2) / real(m, DP)
          call suite%that(entry%name // ': outward', dot_product(normal, middle - centre) > 0.1_DP)
          do k = m + 1, shape%n_nodes
            call suite%near(entry%name // ': mid-side', norm2(xi(:, nodes(k)) - 0.5_DP * (xi(:, nodes(k - m)) &
              + xi(:, nodes(modulo(k - m, m) + 1)))), 0.0_DP, 1.0e-15_DP)
          end do
        end associate
      end do
    end do
  end subroutine check_faces


  !> Corners are never more than nodes, nodes never more than the arrays.
  subroutine check_facets()
    type(facet_kind_type) :: shape
    integer :: kind
    do kind = FACET_TRI3, FACET_LINE3
      shape = facet_kind(kind)
      call suite%that('a facet', shape%n_corners >= 2 .and. shape%n_corners <= shape%n_nodes .and. shape%n_nodes <= MAX_FACE_NODES)
    end do
  end subroutine check_facets

end program test_element_kinds
