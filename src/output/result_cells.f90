!> Cell data of the result file: body, material, section and label of each element, and membership in the element sets of the deck.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The arrays are static: the tables of /VTKHDF/Steps give all frames the same cells, so that one copy serves them all. The file
!! that ties partitions has those of the partitions as virtual data sets.
module amontons_result_cells
  use amontons_errors, only: error_type
  use amontons_mesh, only: mesh_type, find_connected_nodes
  use amontons_hdf5_file, only: create_group, hdf5_file_type, hdf5_layout_type, write_data, STORAGE_I32, STORAGE_U8
  use amontons_virtual_data_sets, only: source_files_type, create_virtual
  implicit none
  private
  public :: write_cells, number_bodies

  integer, parameter :: MAX_SETS = 100          !< element sets that become arrays; /AMONTONS/mesh/element_sets has all [-]
  character(*), parameter :: ROOT = '/VTKHDF/CellData/'

contains

  !> /VTKHDF/CellData. Cells beyond the elements are those of analytic surfaces: 0 in all arrays. Errors: EXIT_IO.
  subroutine write_cells(store, mesh, body, n_drawn, error, sources, n_cells)
    type(hdf5_file_type), intent(in) :: store
    type(mesh_type), intent(in) :: mesh           !< with `sources` the whole one, of which only the names of sets are used
    integer, intent(in) :: body(:)                !< (n_elements) of number_bodies
    integer, intent(in) :: n_drawn                !< cells of analytic surfaces, after the elements
    type(error_type), allocatable, intent(out) :: error
    type(source_files_type), intent(in), optional :: sources   !< files of the partitions, which have the arrays
    integer, intent(in), optional :: n_cells(:)   !< in each of them
    integer :: i
    call create_group(store, '/VTKHDF/CellData', error)
    call put('BODY', body, 'Body of each element, counted from 1: elements that share nodes.')
    call put('MATERIAL', mesh%material, 'Material of each element, counted from 1 as in /AMONTONS/materials; 0: none.')
    call put('SECTION', mesh%section, &
      'Section of each element: its *SOLID SECTION, *SHELL SECTION, ... counted from 1 in the order of the deck; 0: none.')
    call put('ELEMENT', mesh%element_label, 'Label of each element in the deck.')
    if (.not. allocated(mesh%element_sets)) return
    do i = 1, min(MAX_SETS, size(mesh%element_sets))
      call put('ELSET ' // name_in_file(mesh%element_sets(i)%name), membership(mesh, i), &
        '1: the element is in this set.', STORAGE_U8)
    end do

  contains

    !> One array, written or tied.
    subroutine put(name, values, description, storage)
      character(*), intent(in) :: name, description
      integer, intent(in) :: values(:)            !< (n_elements)
      integer, intent(in), optional :: storage
      type(hdf5_layout_type) :: form
      integer :: i
      if (allocated(error)) return
      form = hdf5_layout_type(storage=STORAGE_I32)
      if (present(storage)) form%storage = storage
      if (present(sources)) then
        call create_virtual(store, sources, n_cells, ROOT // name, form, .false., '[-]', description, error)
      else
        call write_data(store, ROOT // name, [values, [(0, i=1, n_drawn)]], '[-]', description, error, form%storage)
      end if
    end subroutine put

  end subroutine write_cells


  !> One element set as 0 and 1 of each element.
  pure function membership(mesh, i) result(is_member)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: i                      !< index into mesh%element_sets
    integer :: is_member(mesh%n_elements)
    is_member = 0
    is_member(mesh%element_sets(i)%members) = 1
  end function membership


  !> The name of a set without what HDF5 takes for a folder.
  pure function name_in_file(name) result(changed)
    character(*), intent(in) :: name
    character(:), allocatable :: changed
    integer :: k
    changed = trim(name)
    do k = 1, len(changed)
      if (changed(k:k) == '/') changed(k:k) = '_'
    end do
  end function name_in_file


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
