!> Ties: what binds displacements together beyond linear equations: rigid bodies, planes, lines, lengths, turns, surfaces.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The formulas stand in amontons_nonlinear_mpc. A rotation vector is the displacement of a node of its own, the rotation node.
module amontons_mpc_data
  use amontons_kinds, only: DP
  use amontons_tensor, only: cross_product
  implicit none
  private
  public :: nonlinear_mpc_type, tie_type, distributing_coupling_type, coordinate_system_type, axes_at
  public :: MPC_RIGID_BODY, MPC_PLANE, MPC_STRAIGHT, MPC_DISTANCE, MPC_MEAN_ROTATION

  integer, parameter :: MPC_RIGID_BODY = 1        !< the nodes move with a reference node as a rigid body
  integer, parameter :: MPC_PLANE = 2       !< the node stays in the plane of three others
  integer, parameter :: MPC_STRAIGHT = 3    !< the node stays on the line through two others
  integer, parameter :: MPC_DISTANCE = 4    !< two nodes keep their distance
  integer, parameter :: MPC_MEAN_ROTATION = 5        !< the mean rotation of the nodes about an axis is the displacement of a pilot

  !> One bond.
  type :: nonlinear_mpc_type
    integer :: kind = MPC_RIGID_BODY
    integer, allocatable :: node(:)          !< the nodes bound; PLANE, STRAIGHT: the node, then those that it follows
    integer :: reference = 0                 !< BODY: the node that they move with; TURN: the pilot, its first displacement
    integer :: rotation = 0                  !< BODY: the node whose displacement is the rotation vector
    logical :: is_bound(3) = .true.          !< BODY: directions that are bound
    real(DP), allocatable :: axes(:, :, :)   !< (3, 3, n) BODY: these directions at each node, columns; else x, y, z
    real(DP) :: axis(3) = 0                  !< TURN: unit vector
    character(:), allocatable :: card        !< keyword, for messages
    integer :: line = 0                      !< line of the card in the deck, for messages
  end type nonlinear_mpc_type

  !> Two surfaces that are one: the nodes of the slave stay on the master where they are at the start.
  type :: tie_type
    integer :: slave = 0                     !< index of the slave surface
    integer :: master = 0                    !< index of the master surface
    real(DP) :: tolerance = -1               !< nodes farther away are not tied; negative: 2.5 % of a facet [length]
    logical :: is_cyclic = .false.           !< CYCLIC SYMMETRY: the slave moves as the master, turned
    real(DP) :: turn(3, 3) = 0               !< by the angle of the sector, about an axis
    real(DP) :: centre(3) = 0                !< through this point [length]
    logical :: is_adjusted = .true.          !< tied nodes are moved onto the master before the start
    character(:), allocatable :: name
    integer :: line = 0                      !< line of the card in the deck, for messages
  end type tie_type

  !> A reference node that moves with the mean rigid motion of a surface (DISTRIBUTING).
  type :: distributing_coupling_type
    integer :: reference = 0
    integer :: rotation = 0                  !< node whose displacement is the rotation vector
    integer :: surface = 0                   !< index of the surface
    logical :: is_bound(3) = .true.          !< rotations that are bound
    real(DP) :: axes(3, 3) = 0               !< directions of the reference node's degrees of freedom, columns
    integer :: line = 0                      !< line of the card in the deck, for messages
  end type distributing_coupling_type

  !> A rule that gives three directions at each point (TRANSFORM, ORIENTATION).
  type :: coordinate_system_type
    character(:), allocatable :: name
    logical :: is_cylindrical = .false.
    real(DP) :: a(3) = [1.0_DP, 0.0_DP, 0.0_DP]   !< rectangular: on the local x axis; cylindrical: on the axis
    real(DP) :: b(3) = [0.0_DP, 1.0_DP, 0.0_DP]   !< rectangular: in the local xy plane; cylindrical: on the axis too
  end type coordinate_system_type

contains

  !> The directions of a rule at a point: x, y, z of a rectangular one; radial, around, along of a cylindrical one.
  pure function axes_at(rule, x) result(axes)
    type(coordinate_system_type), intent(in) :: rule
    real(DP), intent(in) :: x(3)                  !< [length]
    real(DP) :: axes(3, 3)                        !< columns
    real(DP) :: along(3), out(3)
    integer :: k
    if (rule%is_cylindrical) then
      along = (rule%b - rule%a) / norm2(rule%b - rule%a)
      out = x - rule%a - dot_product(x - rule%a, along) * along
      if (norm2(out) <= 1.0e-10_DP * norm2(rule%b - rule%a)) then   ! on the axis any direction serves
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

end module amontons_mpc_data
