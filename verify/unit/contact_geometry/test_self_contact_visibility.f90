!> Tests of what a node sees in self contact: neither its neighbours nor the far side of the material, but the other arm.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_self_contact_visibility
  use amontons_kinds, only: DP, PI
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_CPE4
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_facets, only: facets_type, build_facets, is_unseen
  use amontons_exterior_surface, only: depths_below
  use amontons_self_contact_visibility, only: find_unseen_facets, current_node_normal
  use check, only: suite_type
  implicit none
  integer, parameter :: N = 40                       !< elements along the strip
  type(suite_type) :: suite
  type(mesh_type) :: mesh
  type(facets_type) :: facets
  call make_hairpin(mesh, facets)
  call check_sight(suite, mesh, facets)
  call check_normal(suite, mesh, facets)
  call suite%finish()

contains

  !> A strip of one element through its thickness 0.1, bent to three quarters of a circle of radius 1 (inner side) about the origin.
  subroutine make_hairpin(mesh, facets)
    type(mesh_type), intent(out) :: mesh
    type(facets_type), intent(out) :: facets
    type(error_type), allocatable :: error
    integer :: e
    real(DP) :: angle
    mesh%n_nodes = 2 * N + 2
    mesh%n_elements = N
    allocate (mesh%coordinates(3, mesh%n_nodes), source=0.0_DP)
    do e = 0, N
      angle = 1.5_DP * PI * real(e, DP) / real(N, DP)
      mesh%coordinates(:2, e + 1) = [cos(angle), sin(angle)]
      mesh%coordinates(:2, N + 2 + e) = 1.1_DP * [cos(angle), sin(angle)]
    end do
    mesh%kind = [(KIND_CPE4, e=1, N)]
    mesh%first = [(4 * e - 3, e=1, N + 1)]
    mesh%nodes = [(e, N + 1 + e, N + 2 + e, e + 1, e=1, N)]
    mesh%node_label = [(e, e=1, mesh%n_nodes)]
    mesh%element_label = [(e, e=1, N)]
    call finalize_mesh(mesh)
    call build_facets(mesh, [(e, e, e=1, N)], [(2, 4, e=1, N)], facets, error)   ! outside and inside, element by element
    if (allocated(error)) error stop 'the sample surface is bad'
    call find_unseen_facets(mesh%coordinates, depths_below(mesh, facets), facets)
  end subroutine make_hairpin


  !> Facet 2e - 1 is outside of element e, 2e inside.
  subroutine check_sight(suite, mesh, facets)
    type(suite_type), intent(inout) :: suite
    type(mesh_type), intent(in) :: mesh
    type(facets_type), intent(in) :: facets
    integer :: e
    e = N / 2
    call suite%that('a node does not see its own facets', is_unseen(facets, e, 2 * e) .and. is_unseen(facets, e, 2 * e - 2))
    call suite%that('nor the next ones', is_unseen(facets, e, 2 * e + 2) .and. is_unseen(facets, e, 2 * e - 4))
    call suite%that('nor the outside of its own element', is_unseen(facets, e, 2 * e - 1))
    call suite%that('nor does the outside see the inside', is_unseen(facets, N + 1 + e, 2 * e))
    call suite%that('it sees the other arm', .not. is_unseen(facets, 2, 2 * (N - 2)) .and. .not. is_unseen(facets, N - 2, 4))
    call suite%that('a few facets are unseen', size(facets%unseen) < 12 * mesh%n_nodes)
  end subroutine check_sight


  !> The normal follows the coordinates: of the strip turned by a right angle it is turned too.
  subroutine check_normal(suite, mesh, facets)
    type(suite_type), intent(inout) :: suite
    type(mesh_type), intent(in) :: mesh
    type(facets_type), intent(in) :: facets
    real(DP) :: turned(3, mesh%n_nodes), normal(3)
    integer :: node
    node = N / 2
    normal = current_node_normal(facets, mesh%coordinates, node)
    call suite%that('inwards', norm2(normal + mesh%coordinates(:, node)) < 1.0e-3_DP)
    turned = 0.0_DP
    turned(1, :) = -mesh%coordinates(2, :)
    turned(2, :) = mesh%coordinates(1, :)
    call suite%that('turned', norm2(current_node_normal(facets, turned, node) - [-normal(2), normal(1), 0.0_DP]) < 1.0e-12_DP)
  end subroutine check_normal

end program test_self_contact_visibility
