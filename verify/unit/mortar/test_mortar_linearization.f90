!> Unit test of amontons_mortar_linearization: derivatives of the rows of slave nodes by all nodes, against differences.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_mortar_linearization
  use amontons_errors, only: error_type
  use amontons_facet_search, only: facet_search_type, build_facet_search
  use amontons_facets, only: facets_type, build_facets
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_mortar, only: mortar_type, create_mortar, integrate_mortar
  use amontons_mortar_linearization, only: row_derivatives_type, differentiate_mortar_row
  use amontons_segment_derivatives, only: facet_derivatives_type
  use amontons_element_kinds, only: KIND_C3D6, KIND_C3D8, KIND_C3D10, KIND_C3D20, FACET_TRI3, FACET_QUAD4, FACET_TRI6, FACET_QUAD8
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer, parameter :: NX = 3, NY = 2
  integer :: kind
  do kind = FACET_TRI3, FACET_QUAD8
    call check_rows(kind)
  end do
  call suite%finish()

contains

  include 'sample_surfaces.inc'
  include 'sample_grids.inc'

  !> The rows of all slave nodes of a grid at coordinates x.
  subroutine integrate(kind, master, search, x, mortar)
    integer, intent(in) :: kind
    type(facets_type), intent(in) :: master
    type(facet_search_type), intent(in) :: search
    real(DP), intent(in) :: x(:, :)
    type(mortar_type), intent(out) :: mortar
    type(mesh_type) :: mesh
    type(error_type), allocatable :: error
    integer, allocatable :: element(:), face(:), nodes(:)
    integer :: i
    call flat_grid(kind, NX, NY, mesh, element, face)
    call build_facets(mesh, element, face, mortar%slave, error)
    nodes = [integer ::]
    do i = 1, mesh%n_nodes
      if (any(mortar%slave%nodes == i)) nodes = [nodes, i]
    end do
    call create_mortar(mesh, element, face, nodes, mortar, error)
    call suite%that('slave surface', .not. allocated(error))
    call integrate_mortar(mortar, master, search, .true., x, 0.5_DP)
  end subroutine integrate


  !> The weight of a mesh node in a row.
  pure function weight_of(mortar, j, node) result(w)
    type(mortar_type), intent(in) :: mortar
    integer, intent(in) :: j, node                 !< row, mesh node
    real(DP) :: w
    w = sum(mortar%rows(j)%weights, mask=mortar%rows(j)%nodes == node)
  end function weight_of


  !> Derivatives of the weights of three rows, one of them at the border of the slave, by all coordinates.
  subroutine check_rows(kind)
    integer, intent(in) :: kind
    type(facets_type) :: slave, master
    type(facet_search_type) :: search
    type(mortar_type) :: mortar, plus, minus
    type(row_derivatives_type) :: derivatives
    type(facet_derivatives_type), allocatable :: facet_derivatives(:)
    real(DP), allocatable :: x(:, :), y(:, :)
    real(DP) :: difference
    real(DP), parameter :: STEP = 1.0e-6_DP
    integer :: rows(3), r, j, k, i, m, n_checked
    call make_grids(kind, .false., slave, master, x, search)
    call integrate(kind, master, search, x, mortar)
    allocate (facet_derivatives(mortar%slave%n))
    rows = size(mortar%nodes) / 2 + [-1, 0, 1]
    n_checked = 0
    do r = 1, 3
      j = rows(r)
      if (mortar%places(j)%facet == 0) cycle
      call differentiate_mortar_row(mortar, master, x, j, facet_derivatives, derivatives)
      call suite%that('first the nodes of the row', all(derivatives%nodes(:size(mortar%rows(j)%nodes)) == mortar%rows(j)%nodes))
      do k = 1, size(derivatives%nodes), 3
        do i = 1, 3
          y = x
          y(i, derivatives%nodes(k)) = x(i, derivatives%nodes(k)) + STEP
          call integrate(kind, master, search, y, plus)
          y(i, derivatives%nodes(k)) = x(i, derivatives%nodes(k)) - STEP
          call integrate(kind, master, search, y, minus)
          do m = 1, size(mortar%rows(j)%nodes)
            difference = (weight_of(plus, j, mortar%rows(j)%nodes(m)) - weight_of(minus, j, mortar%rows(j)%nodes(m))) / (2 * STEP)
            call suite%near('derivative of a weight', derivatives%d_weights(m, i, k), difference, 1.0e-6_DP)
            if (abs(difference) > 1.0e-3_DP) n_checked = n_checked + 1
          end do
        end do
      end do
    end do
    call suite%that('many are not zero', n_checked > 20)
  end subroutine check_rows

end program test_mortar_linearization
