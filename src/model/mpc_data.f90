!> Data of nonlinear multi-point constraints, tie constraints, distributing couplings and local coordinate systems.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The formulas are in `nonlinear_mpc`. A rotation vector is stored as the displacement of a rotation node.
module amontons_mpc_data
  use amontons_kinds, only: DP
  use amontons_tensor, only: cross_product
  implicit none
  private
  public :: nonlinear_mpc_type, nonlinear_mpc_list_type, tie_type, distributing_coupling_type, coordinate_system_type, axes_at
  public :: MPC_RIGID_BODY, MPC_PLANE, MPC_STRAIGHT, MPC_DISTANCE, MPC_MEAN_ROTATION, MPC_FITTED_ROTATION

  integer, parameter :: MPC_RIGID_BODY = 1        !< the nodes move with a reference node as a rigid body
  integer, parameter :: MPC_PLANE = 2       !< the node stays in the plane of three others
  integer, parameter :: MPC_STRAIGHT = 3    !< the node stays on the line through two others
  integer, parameter :: MPC_DISTANCE = 4    !< two nodes keep their distance
  integer, parameter :: MPC_MEAN_ROTATION = 5        !< the mean rotation of the nodes about an axis is the displacement of a pilot
  integer, parameter :: MPC_FITTED_ROTATION = 6      !< the rotation vector is that of the rotation that fits the nodes best

  !> One nonlinear multi-point constraint.
  type :: nonlinear_mpc_type
    integer :: kind = MPC_RIGID_BODY
    integer, allocatable :: node(:)          !< the constrained nodes; PLANE, STRAIGHT: the node, then those that define it
    integer :: reference = 0                 !< BODY: the reference node; MEAN_ROTATION: the pilot node, its first displacement
    integer :: rotation = 0                  !< BODY, FITTED_ROTATION: the rotation node
    integer :: expansion = 0                 !< BODY: the node whose first displacement is its uniform stretch, 0: it is rigid
    integer :: pilot_direction = 1           !< MEAN_ROTATION: the displacement of the pilot node that is the angle
    logical :: is_pilot_turned = .false.     !< that displacement is the one along the axis, a local direction of the pilot node
    logical :: is_bound(3) = .true.          !< BODY: constrained directions
    real(DP), allocatable :: axes(:, :, :)   !< (3, 3, n) BODY: these directions at each node, columns; else x, y, z
    real(DP) :: axis(3) = 0                  !< MEAN_ROTATION: unit vector of the axis
    character(:), allocatable :: card        !< keyword, for messages
    integer :: line = 0                      !< line of the card in the deck, for messages
  end type nonlinear_mpc_type

  !> Nonlinear multi-point constraints that are added one by one. The array doubles when it is full, and its items are moved, not
  !! copied.
  type :: nonlinear_mpc_list_type
    type(nonlinear_mpc_type), allocatable :: items(:)
    integer :: n = 0                         !< constraints; the rest of the items is empty
  contains
    procedure :: add => add_mpc_to_list
    procedure :: move_to => move_mpcs_to
  end type nonlinear_mpc_list_type

  !> A tie constraint: the slave nodes keep their initial position relative to the master.
  type :: tie_type
    integer :: slave = 0                     !< index of the slave surface
    integer :: master = 0                    !< index of the master surface
    real(DP) :: tolerance = -1               !< nodes farther away are not tied; negative: 2.5 % of a facet, 5 % of the spacing of
                                             !! nodes [length]
    logical :: may_be_nodal = .false.        !< TIE: the master may be made of nodes
    logical :: is_shell_edge = .false.       !< SHELL TO SOLID COUPLING: the slave, edges of shells, moves as the mean of the master
    logical :: is_cyclic = .false.           !< CYCLIC SYMMETRY: the slave moves as the master, rotated
    real(DP) :: turn(3, 3) = 0               !< by the angle of the sector, about an axis
    real(DP) :: centre(3) = 0                !< through this point [length]
    logical :: is_adjusted = .true.          !< tied nodes are moved onto the master before the start
    character(:), allocatable :: name
    integer :: line = 0                      !< line of the card in the deck, for messages
  end type tie_type

  !> A distributing coupling: a reference node moves with the mean rigid body motion of a surface, or of nodes with weights.
  type :: distributing_coupling_type
    integer :: reference = 0
    integer :: rotation = 0                  !< rotation node
    integer :: surface = 0                   !< index of the surface; 0: nodes and weights are given
    integer, allocatable :: nodes(:)         !< DISTRIBUTING COUPLING: its nodes
    real(DP), allocatable :: weight(:)       !< of them, positive [-]
    logical :: is_bound(3) = .true.          !< constrained rotations
    real(DP) :: axes(3, 3) = 0               !< directions of the reference node's degrees of freedom, columns
    integer :: line = 0                      !< line of the card in the deck, for messages
  end type distributing_coupling_type

  !> A local coordinate system with three directions at each point (TRANSFORM, ORIENTATION).
  type :: coordinate_system_type
    character(:), allocatable :: name
    logical :: is_cylindrical = .false.
    real(DP) :: a(3) = [1.0_DP, 0.0_DP, 0.0_DP]   !< rectangular: on the local x axis; cylindrical: on the axis
    real(DP) :: b(3) = [0.0_DP, 1.0_DP, 0.0_DP]   !< rectangular: in the local xy plane; cylindrical: on the axis too
  end type coordinate_system_type

contains

  !> The directions of a local system at a point: x, y, z if rectangular; radial, circumferential, axial if cylindrical.
  pure function axes_at(rule, x) result(axes)
    type(coordinate_system_type), intent(in) :: rule
    real(DP), intent(in) :: x(3)                  !< [length]
    real(DP) :: axes(3, 3)                        !< columns
    real(DP) :: along(3), out(3)
    integer :: k
    if (rule%is_cylindrical) then
      along = (rule%b - rule%a) / norm2(rule%b - rule%a)
      out = x - rule%a - dot_product(x - rule%a, along) * along
      if (norm2(out) <= 1.0e-10_DP * norm2(rule%b - rule%a)) then   ! any direction on the axis
        k = minloc(abs(along), dim=1)
        out = -along(k) * along
        out(k) = out(k) + 1.0_DP
      end if
      axes(:, 1) = out / norm2(out)
      axes(:, 3) = along
      axes(:, 2) = cross_product(along, axes(:, 1))
    else
      axes(:, 1) = rule%a / norm2(rule%a)
      axes(:, 3) = cross_product(rule%a, rule%b)
      axes(:, 3) = axes(:, 3) / norm2(axes(:, 3))
      axes(:, 2) = cross_product(axes(:, 3), axes(:, 1))
    end if
  end function axes_at


  !> Adds a constraint. Cost: constant in the mean.
  pure subroutine add_mpc_to_list(self, mpc)
    class(nonlinear_mpc_list_type), intent(inout) :: self
    type(nonlinear_mpc_type), intent(in) :: mpc
    if (.not. allocated(self%items)) allocate (self%items(16))
    if (self%n == size(self%items)) call resize_mpcs(self%items, 2 * self%n)
    self%n = self%n + 1
    self%items(self%n) = mpc
  end subroutine add_mpc_to_list


  !> Moves the constraints into an array of their number, after those that are there. After: the list is empty.
  pure subroutine move_mpcs_to(self, mpcs)
    class(nonlinear_mpc_list_type), intent(inout) :: self
    type(nonlinear_mpc_type), allocatable, intent(inout) :: mpcs(:)
    integer :: i, n_before
    if (.not. allocated(mpcs)) allocate (mpcs(0))
    n_before = size(mpcs)
    call resize_mpcs(mpcs, n_before + self%n)
    do i = 1, self%n
      call move_mpc(self%items(i), mpcs(n_before + i))
    end do
    self%n = 0
  end subroutine move_mpcs_to


  !> Changes the size of an array of constraints; those that both sizes have are moved.
  pure subroutine resize_mpcs(mpcs, n)
    type(nonlinear_mpc_type), allocatable, intent(inout) :: mpcs(:)
    integer, intent(in) :: n
    type(nonlinear_mpc_type), allocatable :: resized(:)
    integer :: i
    allocate (resized(n))
    do i = 1, min(n, size(mpcs))
      call move_mpc(mpcs(i), resized(i))
    end do
    call move_alloc(resized, mpcs)
  end subroutine resize_mpcs


  !> Moves a constraint; the allocatable parts of the first one are deallocated after.
  pure subroutine move_mpc(from, to)
    type(nonlinear_mpc_type), intent(inout) :: from
    type(nonlinear_mpc_type), intent(out) :: to
    to%kind = from%kind
    call move_alloc(from%node, to%node)
    to%reference = from%reference
    to%rotation = from%rotation
    to%expansion = from%expansion
    to%pilot_direction = from%pilot_direction
    to%is_pilot_turned = from%is_pilot_turned
    to%is_bound = from%is_bound
    call move_alloc(from%axes, to%axes)
    to%axis = from%axis
    call move_alloc(from%card, to%card)
    to%line = from%line
  end subroutine move_mpc

end module amontons_mpc_data
