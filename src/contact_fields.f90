!> Contact fields: what the points of slave faces carry, gathered at the nodes of the faces, and where a point is.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_contact_fields
  use amontons_kinds, only: DP
  use amontons_topology, only: element_kind, kind_type, MAX_FACE_NODES
  use amontons_shapes, only: facet_shapes
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_surfaces, only: BEHAVIOR_LINEAR
  use amontons_state, only: slave_type, STATUS_OPEN, STATUS_SLIP
  implicit none
  private
  public :: nodal_slaves, n_nodal_slaves, slave_position, shown_slip, shown_energy

contains

  !> How many slaves `nodal_slaves` gives: the same throughout a job.
  pure integer function n_nodal_slaves(model, slaves) result(n)
    type(model_type), intent(in) :: model
    type(slave_type), intent(in) :: slaves(:)
    integer :: p
    n = count(slaves%side == 0)
    do p = 1, size(model%pairs)
      if (model%pairs(p)%is_pointwise) n = n + size(model%surfaces(model%pairs(p)%slave)%nodes)
    end do
  end function n_nodal_slaves


  !> The slave nodes, and for a pair with points each node of its slave surface with what the points around it carry.
  !!
  !! A point gives to the nodes of its face by the shape functions that are positive there, so that a node never pulls: forces,
  !! areas and energies as sums, gap, normal and slip as means over the areas. A node is closed if a point of its is, and slips if
  !! one does.
  function nodal_slaves(model, slaves) result(nodal)
    type(model_type), intent(in) :: model
    type(slave_type), intent(in) :: slaves(:)
    type(slave_type), allocatable :: nodal(:)
    integer, allocatable :: at(:)                  ! (n_nodes) place of a node among those of the pair
    integer :: p, i, before
    nodal = pack(slaves, slaves%side == 0)
    do p = 1, size(model%pairs)
      if (.not. model%pairs(p)%is_pointwise) cycle
      before = size(nodal)
      associate (nodes => model%surfaces(model%pairs(p)%slave)%nodes)
        allocate (at(model%mesh%n_nodes), source=0)
        at(nodes) = [(before + i, i=1, size(nodes))]
        nodal = [nodal, [(slave_type(pair=p, node=nodes(i)), i=1, size(nodes))]]
      end associate
      do i = 1, size(slaves)
        if (slaves(i)%pair == p) call give_point(model, slaves(i), at, nodal)
      end do
      do i = before + 1, size(nodal)
        call take_mean(nodal(i))
      end do
      deallocate (at)
    end do
  end function nodal_slaves


  !> What one point gives to the nodes of its face.
  subroutine give_point(model, point, at, nodal)
    type(model_type), intent(in) :: model
    type(slave_type), intent(in) :: point
    integer, intent(in) :: at(:)                   !< (n_nodes)
    type(slave_type), intent(inout) :: nodal(:)
    integer :: nodes(MAX_FACE_NODES), n, i
    real(DP) :: N_i(MAX_FACE_NODES), share
    call face_of(model, point, n, nodes, N_i)
    N_i(:n) = max(N_i(:n), 0.0_DP)
    do i = 1, n
      share = N_i(i) / sum(N_i(:n))
      associate (node => nodal(at(nodes(i))))
        node%area = node%area + share * point%area
        node%gap = node%gap + share * point%area * point%gap
        node%normal = node%normal + share * point%area * point%normal
        node%slip = node%slip + share * point%area * point%slip
        node%elastic = node%elastic + share * point%area * point%elastic
        node%slip_increment = node%slip_increment + share * point%area * point%slip_increment
        node%force = node%force + share * point%force
        node%shear = node%shear + share * point%shear
        node%energy = node%energy + share * point%energy
        if (share > 0.0_DP) node%facet = point%facet
        if (point%status == STATUS_OPEN .or. share <= 0.0_DP) cycle
        node%status = max(node%status, point%status)
        if (point%status == STATUS_SLIP) node%scenario = max(node%scenario, point%scenario)
      end associate
    end do
  end subroutine give_point


  !> Sums over areas become means.
  pure subroutine take_mean(node)
    type(slave_type), intent(inout) :: node
    if (node%area <= 0.0_DP) return
    node%gap = node%gap / node%area
    node%slip = node%slip / node%area
    node%elastic = node%elastic / node%area
    node%slip_increment = node%slip_increment / node%area
    node%normal = node%normal / max(norm2(node%normal), tiny(1.0_DP))
  end subroutine take_mean


  !> The nodes of the face of a point and their shape functions there.
  subroutine face_of(model, point, n, nodes, N_i)
    type(model_type), intent(in) :: model
    type(slave_type), intent(in) :: point
    integer, intent(out) :: n
    integer, intent(out) :: nodes(MAX_FACE_NODES)
    real(DP), intent(out) :: N_i(MAX_FACE_NODES)   !< [-]
    real(DP) :: dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    type(kind_type) :: kind
    associate (surface => model%surfaces(model%pairs(point%pair)%slave), mesh => model%mesh)
      associate (e => surface%element(point%side), face => surface%face(point%side))
        kind = element_kind(mesh%kind(e))
        n = count(kind%face_nodes(:, face) > 0)
        nodes = 0
        nodes(:n) = mesh%nodes(mesh%first(e) - 1 + kind%face_nodes(:n, face))
        call facet_shapes(kind%face_kind(face), point%at, N_i, dN, ddN)
      end associate
    end associate
  end subroutine face_of


  !> The slip of a slave as tables and fields show it: CalculiX shows none of its springs where there is no friction.
  pure function shown_slip(model, slave) result(slip)
    type(model_type), intent(in) :: model
    type(slave_type), intent(in) :: slave
    real(DP) :: slip(3)                            !< [length]
    slip = slave%slip + slave%elastic
    if (model%dialect /= DIALECT_CALCULIX .or. slave%row > 0 .and. slave%side == 0 .or. norm2(slave%elastic) > 0.0_DP) return
    if (model%interactions(model%pairs(slave%pair)%interaction)%friction <= 0.0_DP) slip = 0.0_DP
  end function shown_slip


  !> The energy of a slave's spring as CONTACT PRINT shows it. CalculiX counts the elastic slip with all of its shear in place of
  !! half of it, and under LINEAR half the pressure times the overclosure at slave nodes.
  pure real(DP) function shown_energy(model, slave) result(energy)
    type(model_type), intent(in) :: model
    type(slave_type), intent(in) :: slave
    real(DP) :: shear_part                         ! half of it
    energy = slave%energy
    if (model%dialect /= DIALECT_CALCULIX .or. slave%row > 0 .and. slave%side == 0) return
    shear_part = -0.5_DP * dot_product(slave%shear, slave%elastic)
    energy = energy + shear_part
    if (slave%side == 0 .and. model%interactions(model%pairs(slave%pair)%interaction)%behavior == BEHAVIOR_LINEAR) &
      energy = 2 * shear_part - 0.5_DP * dot_product(slave%force, slave%normal) * slave%gap
  end function shown_energy


  !> Where a slave is: its node, or its place on its face.
  function slave_position(model, slave, u) result(x)
    type(model_type), intent(in) :: model
    type(slave_type), intent(in) :: slave
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) displacement [length]
    real(DP) :: x(3)                               !< [length]
    integer :: nodes(MAX_FACE_NODES), n
    real(DP) :: N_i(MAX_FACE_NODES)
    x = model%mesh%coordinates(:, slave%node) + u(:, slave%node)
    if (slave%side == 0) return
    call face_of(model, slave, n, nodes, N_i)
    x = matmul(model%mesh%coordinates(:, nodes(:n)) + u(:, nodes(:n)), N_i(:n))
  end function slave_position

end module amontons_contact_fields
