!> Fields at the nodes: displacement, stress, contact, section forces in the order of the result file, of all nodes or of some.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Values of some nodes are bitwise those of the same nodes among all: a nodal mean counts all elements at its node, in the order
!! of the mesh. Memory and time for the stresses grow with the nodes selected.
module amontons_nodal_fields
  use amontons_kinds, only: DP
  use amontons_tensor, only: von_mises
  use amontons_mesh, only: mesh_type
  use amontons_materials, only: HISTORY_PEEQ
  use amontons_surfaces, only: is_compliant
  use amontons_model, only: model_type, absent_elements, is_out
  use amontons_state, only: history_variable, fields_type, slave_state_type, STATUS_OPEN
  use amontons_dual_shape_functions, only: BASIS_ALPHA
  use amontons_section_forces, only: find_section_forces, find_node_rotations, N_SECTION_FORCES
  use amontons_result_schema, only: field_rows, N_POINT_REALS
  use amontons_postprocess, only: average_at_nodes, find_edge_corners
  implicit none
  private
  public :: node_selection_type, select_all_nodes, select_nodes, list_slave_edges
  public :: point_fields, structure_fields, list_midside_nodes, fill_midside_values, STATUS_NO_SLAVE

  !> Some nodes of a mesh.
  type :: node_selection_type
    integer, allocatable :: nodes(:)              !< (n) ascending
    integer, allocatable :: place(:)              !< (n_nodes) index into nodes; 0: not selected
    integer, allocatable :: elements(:)           !< that have one of these nodes, ascending
  end type node_selection_type

  real(DP), parameter :: TOL_EQUAL_VALUE = 1.0e-6_DP       !< relative difference of equal contact forces or gaps [-]
  integer, parameter :: STATUS_NO_SLAVE = -1      !< CSTATUS of a node that is no slave

contains

  !> All nodes.
  pure function select_all_nodes(mesh) result(selection)
    type(mesh_type), intent(in) :: mesh
    type(node_selection_type) :: selection
    integer :: i
    selection%nodes = [(i, i=1, mesh%n_nodes)]
    selection%place = selection%nodes
    selection%elements = [(i, i=1, mesh%n_elements)]
  end function select_all_nodes


  !> The nodes that are marked. Cost: linear in the mesh.
  pure function select_nodes(mesh, is_selected) result(selection)
    type(mesh_type), intent(in) :: mesh
    logical, intent(in) :: is_selected(:)         !< (n_nodes)
    type(node_selection_type) :: selection
    logical :: is_near(mesh%n_elements)
    integer :: i
    selection%nodes = pack([(i, i=1, mesh%n_nodes)], is_selected)
    allocate (selection%place(mesh%n_nodes), source=0)
    selection%place(selection%nodes) = [(i, i=1, size(selection%nodes))]
    do i = 1, mesh%n_elements
      is_near(i) = any(is_selected(mesh%nodes(mesh%first(i):mesh%first(i + 1) - 1)))
    end do
    selection%elements = pack([(i, i=1, mesh%n_elements)], is_near)
  end function select_nodes


  !> The mid-side nodes of the faces of all slave surfaces with the corners beside them, from which the contact fields there follow.
  subroutine list_slave_edges(model, edges)
    type(model_type), intent(in) :: model
    integer, allocatable, intent(out) :: edges(:, :)   !< (3, n) node, two corners; a node of several surfaces comes as often
    integer, allocatable :: ends(:, :), longer(:, :)
    integer :: p, i, n
    allocate (edges(3, 0))
    do p = 1, size(model%pairs)
      call find_edge_corners(model, model%pairs(p)%slave, .false., ends)
      n = size(edges, 2)
      allocate (longer(3, n + count(ends(1, :) > 0)))
      longer(:, :n) = edges
      do i = 1, size(ends, 2)
        if (ends(1, i) == 0) cycle
        n = n + 1
        longer(:, n) = [i, ends(:, i)]
      end do
      call move_alloc(longer, edges)
    end do
  end subroutine list_slave_edges


  !> The fields at the selected nodes in the order of the file, one below the other. Corners beside mid-side nodes of slave faces
  !! are selected with them.
  subroutine point_fields(model, selection, fields, slaves, no_projection_gap, reals, integers)
    type(model_type), intent(in) :: model
    type(node_selection_type), intent(in) :: selection
    type(fields_type), intent(in) :: fields
    type(slave_state_type), intent(in) :: slaves(:)       !< as nodal_slaves gives them
    real(DP), intent(in) :: no_projection_gap                     !< COPEN without a facet [length]
    real(DP), intent(out) :: reals(:, :)            !< (N_POINT_REALS, n) in the order of POINT_COLUMNS
    integer, intent(out) :: integers(:, :)          !< (N_POINT_INTEGERS, n) likewise
    integer, allocatable :: midside_nodes(:, :)
    integer :: i, at, cpress(2), cshear(2), cslip(2)
    cpress = field_rows('CPRESS')
    cshear = field_rows('CSHEAR')
    cslip = field_rows('CSLIP')
    call pack_solid(model%mesh, absent_elements(model, fields%step), selection, fields, reals)
    call pack_contact(slaves, selection%place, no_projection_gap, reals, integers)
    call fill_midside_values(model, slaves, cpress(1), cshear(2), reals, selection%place)
    call list_midside_nodes(model, slaves, midside_nodes)
    do i = 1, size(midside_nodes, 2)                   ! pressure, friction, gap and slip; the forces are those of the corners
      at = selection%place(midside_nodes(1, i))
      if (at == 0) cycle
      associate (ends => selection%place(midside_nodes(2:3, i)))
        reals(cpress(1):cslip(2), at) = 0.5_DP * sum(reals(cpress(1):cslip(2), ends), dim=2)
        integers(1, at) = maxval(integers(1, ends))
      end associate
    end do
  end subroutine point_fields


  !> Rotations, section forces and moments at the selected nodes of the deck and those into which they expand.
  subroutine structure_fields(model, selection, fields, reals)
    type(model_type), intent(in) :: model
    type(node_selection_type), intent(in) :: selection
    type(fields_type), intent(in) :: fields
    real(DP), intent(out) :: reals(:, :)            !< (12, n) in the order of STRUCTURE_COLUMNS
    real(DP), allocatable :: of_all(:, :)
    allocate (of_all(size(reals, 1), model%mesh%n_nodes))
    call pack_structure(model, fields, of_all)
    reals = of_all(:, selection%nodes)
  end subroutine structure_fields


  !> The same of all nodes.
  subroutine pack_structure(model, fields, reals)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    real(DP), intent(out) :: reals(:, :)            !< (12, n_nodes) in the order of STRUCTURE_COLUMNS
    real(DP), allocatable :: forces(:, :)
    integer :: n_elements_of(size(reals, 2)), e, i
    allocate (forces(N_SECTION_FORCES, model%mesh%n_elements))
    reals = 0
    n_elements_of = 0
    call find_node_rotations(model, fields, reals(:3, :))
    call find_section_forces(model, fields, forces)
    associate (structure => model%structure)
      do e = 1, model%mesh%n_elements
        if (structure%section(e) == 0 .or. model%mesh%layer(e) > 1 .or. is_out(model, fields%step, e)) cycle
        associate (nodes => structure%nodes(structure%first(e):structure%first(e + 1) - 1))
          n_elements_of(nodes) = n_elements_of(nodes) + 1
          do i = 1, size(nodes)
            reals(4:, nodes(i)) = reals(4:, nodes(i)) + (forces(:, e) - reals(4:, nodes(i))) / real(n_elements_of(nodes(i)), DP)
          end do
        end associate
      end do
      do i = 1, size(structure%directors)
        associate (director => structure%directors(i))
          reals(4:, director%nodes) = spread(reals(4:, director%node), 2, size(director%nodes))
        end associate
      end do
    end associate
  end subroutine pack_structure


  !> Displacement, reaction, stress, strain, Mises stress, plastic strain and temperature.
  subroutine pack_solid(mesh, is_absent, selection, fields, reals)
    type(mesh_type), intent(in) :: mesh
    logical, intent(in) :: is_absent(:)            !< (n_elements) taken out
    type(node_selection_type), intent(in) :: selection
    type(fields_type), intent(in) :: fields
    real(DP), intent(out) :: reals(:, :)            !< (N_POINT_REALS, n) in the order of POINT_COLUMNS
    integer :: u(2), rf(2), s(2), e(2), mises(2), peeq(2), nt(2), i
    u = field_rows('U')
    rf = field_rows('RF')
    s = field_rows('S')
    e = field_rows('E')
    mises = field_rows('S_mises')
    peeq = field_rows('PEEQ')
    nt = field_rows('NT')
    reals = 0                                       ! columns of slave nodes elsewhere, and PEEQ without plasticity
    associate (nodes => selection%nodes)
      reals(u(1):u(2), :) = fields%u(:, nodes)
      reals(rf(1):rf(2), :) = fields%reaction_force(:, nodes)
      reals(nt(1), :) = fields%temperature(nodes)
    end associate
    !$omp parallel sections
    !$omp section
    call average_at_nodes(mesh, is_absent, fields%stress, reals(s(1):s(2), :), .false., selection%elements, selection%place)
    !$omp section
    call average_at_nodes(mesh, is_absent, fields%strain, reals(e(1):e(2), :), .false., selection%elements, selection%place)
    !$omp end parallel sections
    !$omp parallel do schedule(static)
    do i = 1, size(reals, 2)
      reals(mises(1), i) = von_mises(reals(s(1):s(2), i))
    end do
    !$omp end parallel do
    if (size(fields%history, 1) > 0) call average_at_nodes(mesh, is_absent, &
      reshape(history_variable(fields, HISTORY_PEEQ), [1, mesh%n_points]), reals(peeq(1):peeq(2), :), .false., &
      selection%elements, selection%place)
  end subroutine pack_solid


  !> The contact columns of the point data. A slave node of two pairs has the values of the pair with precedence.
  subroutine pack_contact(slaves, place, no_projection_gap, reals, integers)
    type(slave_state_type), intent(in) :: slaves(:)
    integer, intent(in) :: place(:)                !< (n_nodes) column of each node; 0: none
    real(DP), intent(in) :: no_projection_gap                     !< COPEN without a facet [length]
    real(DP), intent(inout) :: reals(:, :)          !< (N_POINT_REALS, n)
    integer, intent(out) :: integers(:, :)          !< (N_POINT_INTEGERS, n)
    integer :: drawn(size(reals, 2)), i, node
    integer :: cpress(2), cshear(2), copen(2), cslip(2), cnormf(2), cshearf(2)
    cpress = field_rows('CPRESS')
    cshear = field_rows('CSHEAR')
    copen = field_rows('COPEN')
    cslip = field_rows('CSLIP')
    cnormf = field_rows('CNORMF')
    cshearf = field_rows('CSHEARF')
    drawn = 0
    do i = 1, size(slaves)
      node = place(slaves(i)%node)
      if (node == 0) cycle
      if (drawn(node) == 0) then
        drawn(node) = i
      else if (has_precedence(slaves(i), slaves(drawn(node)))) then
        drawn(node) = i
      end if
    end do
    integers = 0
    integers(1, :) = STATUS_NO_SLAVE
    do node = 1, size(drawn)
      if (drawn(node) == 0) cycle
      associate (slave => slaves(drawn(node)))
        if (slave%area > 0) then
          reals(cpress(1), node) = dot_product(slave%force, slave%normal) / slave%area
          reals(cshear(1):cshear(2), node) = slave%shear / slave%area
        end if
        reals(copen(1), node) = merge(slave%gap, no_projection_gap, slave%facet > 0)
        reals(cslip(1):cslip(2), node) = slave%slip
        reals(cnormf(1):cnormf(2), node) = slave%force
        reals(cshearf(1):cshearf(2), node) = slave%shear
        integers(:, node) = [slave%status, slave%scenario]
      end associate
    end do
  end subroutine pack_contact


  !> Precedence of slave a over b at a node: closed before open; if both are closed the larger force; if both are open the smaller
  !! gap; if equal up to rounding the pair that comes first in the deck.
  pure function has_precedence(a, b) result(is_more)
    type(slave_state_type), intent(in) :: a, b
    logical :: is_more
    if ((a%status == STATUS_OPEN) .neqv. (b%status == STATUS_OPEN)) then
      is_more = b%status == STATUS_OPEN
    else if (a%status /= STATUS_OPEN) then
      is_more = norm2(a%force) > (1 + TOL_EQUAL_VALUE) * norm2(b%force)
    else
      is_more = a%facet > 0 .and. (b%facet == 0 .or. a%gap < b%gap - TOL_EQUAL_VALUE * abs(b%gap))
    end if
  end function has_precedence


  !> Mid-side nodes constrained to the slave nodes at their corners (exact node-to-surface contact); fields have the corners' mean.
  subroutine list_midside_nodes(model, slaves, midside_nodes)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slaves(:)      !< of nodal_slaves
    integer, allocatable, intent(out) :: midside_nodes(:, :)   !< (3, n) the node and its two corners
    integer, allocatable :: ends(:, :), corners(:, :), nodes(:)
    logical :: is_shown(model%mesh%n_nodes)
    integer :: p, n
    allocate (corners(2, model%mesh%n_nodes), source=0)
    is_shown = .false.
    is_shown(slaves%node) = .true.
    do p = 1, size(model%pairs)
      associate (pair => model%pairs(p))
        if (pair%is_mortar .or. is_compliant(model%interactions(pair%interaction))) cycle
        call find_edge_corners(model, pair%slave, .false., ends)
      end associate
      do n = 1, size(ends, 2)
        if (ends(1, n) == 0 .or. is_shown(n)) cycle
        is_shown(n) = .true.
        corners(:, n) = ends(:, n)
      end do
    end do
    nodes = pack([(n, n=1, size(corners, 2))], corners(1, :) > 0)
    midside_nodes = reshape([(nodes(n), corners(:, nodes(n)), n=1, size(nodes))], [3, size(nodes)])
  end subroutine list_midside_nodes


  !> Contact stresses at the mid-side nodes of quadratic faces of mortar pairs. Slave values belong to the transformed functions;
  !! the field is (1 - 2 alpha) times the value of the node plus alpha times those of both corners (doc/theory/contact.md,
  !! "Quadratic slave faces").
  subroutine fill_midside_values(model, slaves, first, last, values, place)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slaves(:)      !< of nodal_slaves
    integer, intent(in) :: first, last             !< rows with the stresses
    real(DP), intent(inout) :: values(:, :)        !< (:, n_nodes), or (:, n) with `place`
    integer, intent(in), optional :: place(:)      !< (n_nodes) column of each node; 0: none
    integer, allocatable :: ends(:, :)
    logical :: is_done(model%mesh%n_nodes)
    integer :: p, i, at, corners(2)
    is_done = .false.
    do p = 1, size(model%pairs)
      if (.not. model%pairs(p)%is_mortar .or. model%pairs(p)%has_point_contact) cycle
      call find_edge_corners(model, model%pairs(p)%slave, .true., ends)
      do i = 1, size(slaves)
        associate (node => slaves(i)%node)
          if (slaves(i)%pair /= p .or. slaves(i)%status == STATUS_OPEN .or. ends(1, node) == 0 .or. is_done(node)) cycle
          is_done(node) = .true.
          at = node
          corners = ends(:, node)
          if (present(place)) then
            at = place(node)
            corners = place(corners)
          end if
          if (at == 0) cycle
          values(first:last, at) = (1 - 2 * BASIS_ALPHA) * values(first:last, at) &
            + BASIS_ALPHA * sum(values(first:last, corners), dim=2)
        end associate
      end do
    end do
  end subroutine fill_midside_values

end module amontons_nodal_fields
