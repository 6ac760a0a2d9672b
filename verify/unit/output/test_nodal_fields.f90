!> Fields at nodes: those of some nodes are bitwise those of the same nodes among all; contact at mid-side nodes of a selection.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_nodal_fields
  use amontons_kinds, only: DP
  use amontons_element_kinds, only: element_kind, element_kind_type, KIND_C3D8, KIND_C3D10, KIND_C3D20, MAX_ELEMENT_NODES
  use amontons_mesh, only: finalize_mesh, mesh_type
  use amontons_model, only: model_type
  use amontons_state, only: fields_type, STATUS_SLIP, STATUS_STICK
  use amontons_shape_functions, only: node_coordinates
  use amontons_result_schema, only: field_rows, N_POINT_INTEGERS, N_POINT_REALS
  use amontons_nodal_fields, only: node_selection_type, select_all_nodes, select_nodes, list_slave_edges, point_fields, &
    list_midside_nodes, fill_midside_values, STATUS_NO_SLAVE
  use check, only: suite_type
  implicit none
  real(DP), parameter :: FAR = 7.0_DP             !< opening without projection [length]
  type(suite_type) :: suite

  call test_selection(suite)
  call test_bits(suite)
  call test_midside_nodes(suite)
  call suite%finish()

contains

  !> A row of three elements of one kind along x, with nodes in common; no contact.
  subroutine make_row(kind, model)
    integer, intent(in) :: kind
    type(model_type), intent(out) :: model
    real(DP) :: xi(3, MAX_ELEMENT_NODES), x(3)
    real(DP), allocatable :: coordinates(:, :)
    type(element_kind_type) :: entry
    integer :: e, a, i, node
    entry = element_kind(kind)
    call node_coordinates(kind, xi)
    associate (mesh => model%mesh)
      allocate (coordinates(3, 3 * entry%n_nodes), mesh%nodes(0))
      do e = 1, 3
        do a = 1, entry%n_nodes
          x = xi(:, a) + [2.0_DP * real(e, DP), 0.0_DP, 0.0_DP]
          node = 0
          do i = 1, mesh%n_nodes
            if (all(abs(coordinates(:, i) - x) < 1.0e-9_DP)) node = i
          end do
          if (node == 0) then
            mesh%n_nodes = mesh%n_nodes + 1
            node = mesh%n_nodes
            coordinates(:, node) = x
          end if
          mesh%nodes = [mesh%nodes, node]
        end do
      end do
      mesh%n_elements = 3
      mesh%kind = spread(kind, 1, 3)
      mesh%first = [(1 + (e - 1) * entry%n_nodes, e=1, 4)]
      mesh%coordinates = coordinates(:, :mesh%n_nodes)
      call finalize_mesh(mesh)
    end associate
    allocate (model%pairs(0), model%surfaces(0), model%steps(1))
  end subroutine make_row


  !> Irregular fields without contact.
  subroutine make_fields(mesh, fields)
    type(mesh_type), intent(in) :: mesh
    type(fields_type), intent(out) :: fields
    integer :: i, k
    fields%u = reshape([(sin(real(i, DP)), i=1, 3 * mesh%n_nodes)], [3, mesh%n_nodes])
    fields%reaction_force = 3.0_DP * fields%u
    fields%temperature = [(cos(real(i, DP)), i=1, mesh%n_nodes)]
    fields%stress = reshape([((sin(1.7_DP * real(i, DP) + real(k, DP)), k=1, 6), i=1, mesh%n_points)], [6, mesh%n_points])
    fields%strain = fields%stress / 3.0_DP
    allocate (fields%history(0, mesh%n_points), fields%slaves(0))
  end subroutine make_fields


  !> Nodes, places and elements of a selection; the second element touches the nodes of the first.
  subroutine test_selection(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(node_selection_type) :: some, all_nodes
    logical, allocatable :: is_in(:)
    call make_row(KIND_C3D8, model)
    allocate (is_in(model%mesh%n_nodes), source=.false.)
    is_in(model%mesh%nodes(:8)) = .true.
    some = select_nodes(model%mesh, is_in)
    all_nodes = select_all_nodes(model%mesh)
    call suite%that('eight nodes', size(some%nodes) == 8 .and. all(is_in(some%nodes)))
    call suite%that('their places', all(some%place(some%nodes) == all_nodes%nodes(:8)) .and. count(some%place > 0) == 8)
    call suite%that('two elements at them', all(some%elements == [1, 2]) .and. size(some%elements) == 2)
    call suite%that('all', size(all_nodes%nodes) == 16 .and. size(all_nodes%elements) == 3)
  end subroutine test_selection


  !> All fields of the nodes of each element alone, of three kinds.
  subroutine test_bits(suite)
    type(suite_type), intent(inout) :: suite
    integer, parameter :: KINDS(3) = [KIND_C3D8, KIND_C3D10, KIND_C3D20]
    type(model_type) :: model
    type(fields_type) :: fields
    type(node_selection_type) :: some
    logical, allocatable :: is_in(:)
    real(DP), allocatable :: whole(:, :), part(:, :)
    integer, allocatable :: numbers(:, :)
    integer :: k, e, n
    do k = 1, size(KINDS)
      call make_row(KINDS(k), model)
      call make_fields(model%mesh, fields)
      n = model%mesh%n_nodes
      allocate (whole(N_POINT_REALS, n), numbers(N_POINT_INTEGERS, n))
      call point_fields(model, select_all_nodes(model%mesh), fields, fields%slaves, FAR, whole, numbers)
      call suite%that('there are stresses', maxval(abs(whole)) > 0.1_DP .and. all(numbers(1, :) == STATUS_NO_SLAVE))
      do e = 1, 3
        allocate (is_in(n), source=.false.)
        is_in(model%mesh%nodes(model%mesh%first(e):model%mesh%first(e + 1) - 1)) = .true.
        some = select_nodes(model%mesh, is_in)
        allocate (part(N_POINT_REALS, size(some%nodes)))
        deallocate (numbers)
        allocate (numbers(N_POINT_INTEGERS, size(some%nodes)))
        call point_fields(model, some, fields, fields%slaves, FAR, part, numbers)
        call suite%that('the same bits', all(part == whole(:, some%nodes)))
        deallocate (is_in, part)
      end do
      deallocate (whole, numbers)
    end do
  end subroutine test_bits


  !> A quadratic face of a hard pair: the mid-side node has the mean of its corners, in a selection that gets them, and the values
  !! of all nodes; a slave node outside the selection leaves no trace.
  subroutine test_midside_nodes(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(fields_type) :: fields
    type(node_selection_type) :: some
    type(element_kind_type) :: entry
    logical, allocatable :: is_in(:)
    real(DP), allocatable :: whole(:, :), part(:, :), values(:, :)
    integer, allocatable :: numbers(:, :), part_numbers(:, :), midside(:, :), edges(:, :)
    integer :: corners(4), middle, i, rows(2)
    call make_row(KIND_C3D20, model)
    entry = element_kind(KIND_C3D20)
    corners = model%mesh%nodes(entry%face_nodes(:4, 1))
    middle = model%mesh%nodes(entry%face_nodes(5, 1))
    deallocate (model%pairs, model%surfaces)
    allocate (model%pairs(1), model%surfaces(1), model%interactions(1))
    model%surfaces(1)%element = [1]
    model%surfaces(1)%face = [1]
    model%surfaces(1)%nodes = corners
    model%pairs(1)%slave = 1
    model%pairs(1)%master = 1
    model%pairs(1)%interaction = 1
    call make_fields(model%mesh, fields)
    deallocate (fields%slaves)
    allocate (fields%slaves(4))
    do i = 1, 4
      fields%slaves(i)%pair = 1
      fields%slaves(i)%node = corners(i)
      fields%slaves(i)%facet = 1
      fields%slaves(i)%area = 2.0_DP
      fields%slaves(i)%normal = [0.0_DP, 0.0_DP, 1.0_DP]
      fields%slaves(i)%force = [0.0_DP, 0.0_DP, 10.0_DP * real(i, DP)]
      fields%slaves(i)%status = merge(STATUS_SLIP, STATUS_STICK, i == 2)
    end do
    allocate (whole(N_POINT_REALS, model%mesh%n_nodes), numbers(N_POINT_INTEGERS, model%mesh%n_nodes))
    call point_fields(model, select_all_nodes(model%mesh), fields, fields%slaves, FAR, whole, numbers)
    rows = field_rows('CPRESS')
    call suite%near('pressure between 5 and 10', whole(rows(1), middle), 7.5_DP, 1.0e-12_DP)
    call suite%that('its status', numbers(1, middle) == max(STATUS_SLIP, STATUS_STICK))
    call list_midside_nodes(model, fields%slaves, midside)
    call suite%that('four mid-side nodes', size(midside, 2) == 4)
    allocate (is_in(model%mesh%n_nodes), source=.false.)
    call list_slave_edges(model, edges)
    i = findloc(edges(1, :), middle, dim=1)
    call suite%that('four edges, one of them with its corners', size(edges, 2) == 4 .and. all(edges(2:, i) == corners(:2)))
    is_in(edges(:, i)) = .true.
    some = select_nodes(model%mesh, is_in)
    allocate (part(N_POINT_REALS, 3), part_numbers(N_POINT_INTEGERS, 3))
    call point_fields(model, some, fields, fields%slaves, FAR, part, part_numbers)
    call suite%that('the same', all(part == whole(:, some%nodes)) .and. all(part_numbers == numbers(:, some%nodes)))
    model%pairs(1)%is_mortar = .true.
    fields%slaves(1)%node = middle                ! of a mortar pair the mid-side node is a slave itself
    values = whole
    call fill_midside_values(model, fields%slaves(:1), rows(1), rows(1), values)
    part = whole(:, some%nodes)
    call fill_midside_values(model, fields%slaves(:1), rows(1), rows(1), part, some%place)
    call suite%that('mortar: changed', abs(values(rows(1), middle) - whole(rows(1), middle)) > 0.0_DP .or. &
      abs(sum(whole(rows(1), corners(:2))) / 2.0_DP - whole(rows(1), middle)) < 1.0e-12_DP)
    call suite%that('mortar: alike', all(part == values(:, some%nodes)))
  end subroutine test_midside_nodes

end program test_nodal_fields
