!> Cell data of the result file: body, material, section and label of each element, and membership in the element sets of the deck.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The arrays are static: the tables of /VTKHDF/Steps give all frames the same cells, so that one copy serves them all.
module amontons_result_cells
  use amontons_errors, only: error_type
  use amontons_mesh, only: mesh_type, find_connected_nodes
  use amontons_hdf5_file, only: create_group, hdf5_file_type, write_data, STORAGE_U8
  implicit none
  private
  public :: write_cells, number_bodies

  integer, parameter :: MAX_SETS = 100          !< element sets that become arrays; /AMONTONS/mesh/element_sets has all [-]
  character(*), parameter :: ROOT = '/VTKHDF/CellData/'

contains

  !> /VTKHDF/CellData. Cells beyond the elements are those of analytic surfaces: 0 in all arrays. Errors: EXIT_IO.
  subroutine write_cells(store, mesh, n_drawn, error)
    type(hdf5_file_type), intent(in) :: store
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: n_drawn                !< cells of analytic surfaces, after the elements
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: none(:)
    integer :: i
    allocate (none(n_drawn), source=0)
    call create_group(store, '/VTKHDF/CellData', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'BODY', [number_bodies(mesh), none], '[-]', &
      'Body of each element, counted from 1: elements that share nodes.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'MATERIAL', [mesh%material, none], '[-]', &
      'Material of each element, counted from 1 as in /AMONTONS/materials; 0: none.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'SECTION', [mesh%section, none], '[-]', &
      'Section of each element: its *SOLID SECTION, *SHELL SECTION, ... counted from 1 in the order of the deck; 0: none.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'ELEMENT', [mesh%element_label, none], '[-]', &
      'Label of each element in the deck.', error)
    if (.not. allocated(mesh%element_sets)) return
    do i = 1, min(MAX_SETS, size(mesh%element_sets))
      if (.not. allocated(error)) call write_set(store, mesh, i, n_drawn, error)
    end do
  end subroutine write_cells


  !> One element set as an array of 0 and 1.
  subroutine write_set(store, mesh, i, n_drawn, error)
    type(hdf5_file_type), intent(in) :: store
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: i                      !< index into mesh%element_sets
    integer, intent(in) :: n_drawn
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: is_member(:)
    character(:), allocatable :: name
    integer :: k
    allocate (is_member(mesh%n_elements + n_drawn), source=0)
    is_member(mesh%element_sets(i)%members) = 1
    name = trim(mesh%element_sets(i)%name)
    do k = 1, len(name)
      if (name(k:k) == '/') name(k:k) = '_'       ! HDF5 takes it for a folder
    end do
    call write_data(store, ROOT // 'ELSET ' // name, is_member, '[-]', '1: the element is in this set.', error, STORAGE_U8)
  end subroutine write_set


  !> Body of each element: elements that share a node, directly or by others; counted from 1 in the order of the elements.
  function number_bodies(mesh) result(body)
    type(mesh_type), intent(in) :: mesh
    integer, allocatable :: body(:)               !< (n_elements)
    integer, allocatable :: of_node(:)
    integer :: n
    call find_connected_nodes(mesh, of_node, n)
    body = of_node(mesh%nodes(mesh%first(:mesh%n_elements)))
  end function number_bodies

end module amontons_result_cells
