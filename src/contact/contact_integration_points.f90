!> Surface-to-surface penalty contact at integration points of the slave faces; points are regenerated at each increment.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, section 8. An integration point is a slave like a node: the weights of its row are the shape
!! functions of its slave face and minus those of the master face. Positions of the points and their master points are determined at
!! the start of an increment; a new point takes the state of the nearest old one of its face.
module amontons_contact_integration_points
  use amontons_kinds, only: DP
  use amontons_element_kinds, only: MAX_FACE_NODES
  use amontons_shape_functions, only: facet_shapes
  use amontons_facets, only: facets_type, facet_nodes
  use amontons_model, only: model_type
  use amontons_state, only: state_type, slave_state_type
  use amontons_contact_constraint_rows, only: contact_row_type, evaluate_facet_weights
  use amontons_facet_search, only: build_facet_search
  use amontons_mortar, only: mortar_type, mortar_node_type, find_search_margin
  use amontons_face_intersection_points, only: facing_point_type, find_facing_points, evaluate_face_normal
  use amontons_contact_pairs, only: contact_type, resize_contact
  implicit none
  private
  public :: update_points, nearest_point

  real(DP), parameter :: TOL_EQUAL_COORDINATE = 1.0e-9_DP         !< two distances in natural coordinates are equal within this [-]

contains

  !> Generates the points of all pairs that have them, in the committed configuration. After: both states have the same slaves,
  !! those of other pairs first.
  subroutine update_points(contact, model, state)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    type(state_type), intent(inout) :: state       !< trial and committed slaves are equal except for changes by an iteration
    type(slave_state_type), allocatable :: old(:), new(:), points(:)
    real(DP), allocatable :: x(:, :)
    integer :: p
    if (.not. any(model%pairs%has_point_contact)) return
    old = pack(state%old%slaves, state%old%slaves%slave_facet == 0)
    new = pack(state%new%slaves, state%new%slaves%slave_facet == 0)
    allocate (x, source=model%mesh%coordinates + state%old%u)
    do p = 1, size(model%pairs)
      if (.not. model%pairs(p)%has_point_contact) cycle
      call create_points(contact, p, x, pack(state%old%slaves, state%old%slaves%pair == p), points)
      old = [old, points]
      new = [new, points]
    end do
    call move_alloc(old, state%old%slaves)
    call move_alloc(new, state%new%slaves)
    call resize_contact(contact, state%new%slaves)
  end subroutine update_points


  !> The points of one pair with their rows, positions and states.
  subroutine create_points(contact, pair, x, before, points)
    type(contact_type), intent(inout) :: contact
    integer, intent(in) :: pair
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates [length]
    type(slave_state_type), intent(in) :: before(:)      !< the committed points of the pair
    type(slave_state_type), allocatable, intent(out) :: points(:)
    type(facing_point_type), allocatable :: face_points(:)
    integer :: first(contact%mortar(pair)%slave%n + 1)
    integer :: i, n
    associate (master => contact%facets(pair), mortar => contact%mortar(pair))
      n = 0
      if (contact%is_removed(pair)) then
        allocate (face_points(0))
      else
        call build_facet_search(master, x, find_search_margin(mortar, contact%reach(pair)), &
          contact%search(pair))
        call find_facing_points(mortar%slave, mortar%depth, master, contact%search(pair), x, &
          contact%reach(pair), face_points, n)
      end if
      call allocate_rows(mortar, n)
      call index_by_facet(before, first)
      allocate (points(n))
      do i = 1, n
        call build_point_row(mortar%slave, master, face_points(i), mortar%rows(i))
        mortar%places(i) = mortar_node_type(facet=face_points(i)%master, xi=face_points(i)%xi, area=face_points(i)%area, &
          normal=evaluate_face_normal(master, x, face_points(i)%master, face_points(i)%xi))
        call inherit_state(before, first, face_points(i), points(i))
        points(i)%pair = pair
        points(i)%row = i
        points(i)%slave_facet = face_points(i)%slave
        points(i)%at = face_points(i)%at
        points(i)%node = nearest_node(mortar%slave, face_points(i))
        points(i)%area = face_points(i)%area
      end do
    end associate
  end subroutine create_points


  !> Allocates rows, positions and origins for n points.
  subroutine allocate_rows(mortar, n)
    type(mortar_type), intent(inout) :: mortar
    integer, intent(in) :: n
    if (allocated(mortar%rows)) deallocate (mortar%rows, mortar%places, mortar%origin_rows, mortar%origin_normal)
    allocate (mortar%rows(n), mortar%places(n), mortar%origin_rows(n))
    allocate (mortar%origin_normal(3, n), source=0.0_DP)
  end subroutine allocate_rows


  !> Start of each slave facet's points: points are ordered by facet.
  pure subroutine index_by_facet(points, first)
    type(slave_state_type), intent(in) :: points(:)
    integer, intent(out) :: first(:)               !< (facets + 1)
    integer :: i
    first = 0
    first(1) = 1
    do i = 1, size(points)
      first(points(i)%slave_facet + 1) = first(points(i)%slave_facet + 1) + 1
    end do
    do i = 2, size(first)
      first(i) = first(i) + first(i - 1)
    end do
  end subroutine index_by_facet


  !> The state of a point from the nearest old one of its facet. A facet without old points has none, but is not at the start of the
  !! job if the pair had points.
  pure subroutine inherit_state(before, first, point, slave)
    type(slave_state_type), intent(in) :: before(:)
    integer, intent(in) :: first(:)                !< (facets + 1) start of each facet's points
    type(facing_point_type), intent(in) :: point
    type(slave_state_type), intent(out) :: slave
    real(DP) :: places(2, first(point%slave + 1) - first(point%slave))
    integer :: i, offset
    offset = first(point%slave) - 1
    do i = 1, size(places, 2)
      places(:, i) = before(offset + i)%at
    end do
    slave%is_initialized = size(before) > 0
    if (size(places, 2) > 0) slave = before(offset + nearest_point(places, point%at))
  end subroutine inherit_state


  !> The old point nearest to a point; of equally near ones (by symmetry, separated by rounding) the first. 0: none.
  pure integer function nearest_point(places, at) result(nearest)
    real(DP), intent(in) :: places(:, :)           !< (2, n) natural coordinates [-]
    real(DP), intent(in) :: at(2)                  !< [-]
    real(DP) :: distance, least
    integer :: i
    nearest = 0
    least = huge(1.0_DP)
    do i = 1, size(places, 2)
      distance = norm2(places(:, i) - at)
      if (distance >= least - TOL_EQUAL_COORDINATE) cycle
      least = distance
      nearest = i
    end do
  end function nearest_point


  !> The row of a point: each node once, also if slave and master share it or a facet is collapsed.
  pure subroutine build_point_row(slave, master, point, row)
    type(facets_type), intent(in) :: slave, master
    type(facing_point_type), intent(in) :: point
    type(contact_row_type), intent(inout) :: row
    real(DP) :: weights(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), of_row(2 * MAX_FACE_NODES)
    integer :: nodes(MAX_FACE_NODES), n, own(2 * MAX_FACE_NODES), m
    m = 0
    call evaluate_facet_weights(slave, point%slave, point%at, n, nodes, weights, dN)
    call add_nodes(nodes(:n), weights(:n), m, own, of_row)
    call evaluate_facet_weights(master, point%master, point%xi, n, nodes, weights, dN)
    call add_nodes(nodes(:n), -weights(:n), m, own, of_row)
    row%nodes = own(:m)
    row%weights = of_row(:m)
    allocate (row%imbalance_nodes(0), row%imbalance_weights(0))           ! the point has no nodal imbalance
  end subroutine build_point_row


  !> Adds the nodes of a facet to those of a row.
  pure subroutine add_nodes(nodes, weights, m, own, of_row)
    integer, intent(in) :: nodes(:)
    real(DP), intent(in) :: weights(:)             !< [-]
    integer, intent(inout) :: m                    !< nodes of the row so far
    integer, intent(inout) :: own(:)
    real(DP), intent(inout) :: of_row(:)           !< [-]
    integer :: i, k
    do i = 1, size(nodes)
      k = findloc(own(:m), nodes(i), dim=1)
      if (k == 0) then
        m = m + 1
        k = m
        own(k) = nodes(i)
        of_row(k) = 0.0_DP
      end if
      of_row(k) = of_row(k) + weights(i)
    end do
  end subroutine add_nodes


  !> The node of the slave facet with the largest weight of a point, for messages.
  pure integer function nearest_node(slave, point) result(node)
    type(facets_type), intent(in) :: slave
    type(facing_point_type), intent(in) :: point
    real(DP) :: N_i(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    integer :: n, nodes(MAX_FACE_NODES)
    call facet_nodes(slave, point%slave, n, nodes)
    call facet_shapes(slave%kind(point%slave), point%at, N_i, dN, ddN)
    node = nodes(maxloc(N_i(:n), dim=1))
  end function nearest_node

end module amontons_contact_integration_points
