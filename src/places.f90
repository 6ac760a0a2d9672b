!> Places: where a point is on a surface, and how that changes; what `gap` finds, on facets and on profiles alike.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_places
  use amontons_kinds, only: DP
  implicit none
  private
  public :: projection_type, gap_derivative_type
  public :: PROJECT_ON, PROJECT_OFF, PROJECT_FAILED

  integer, parameter :: PROJECT_ON = 0       !< the point is on a facet (or in its extension zone)
  integer, parameter :: PROJECT_OFF = 1      !< the point is beyond a free edge or a crease that sticks out
  integer, parameter :: PROJECT_FAILED = 2   !< no projection found: too far from the facet, or too strongly bent

  !> Where a point is on a surface.
  type :: projection_type
    integer :: status = PROJECT_FAILED       !< PROJECT_...
    integer :: facet = 0                     !< 0: none
    real(DP) :: xi(2) = 0                    !< natural coordinates [-]
    real(DP) :: gap = 0                      !< signed distance along the normal, negative is penetration [length]
    real(DP) :: normal(3) = 0                !< unit normal out of the master [-]
  end type projection_type

  !> Exact first derivatives of projection, gap and normal by the slave node and by all nodes of the facet's stencil.
  !! The nodes that carry weight, those of the facet, come first.
  type :: gap_derivative_type
    integer :: n_nodes = 0                       !< nodes of the stencil
    integer :: n_weights = 0                     !< of them, those of the facet
    integer, allocatable :: nodes(:)             !< (n_nodes) mesh nodes
    real(DP), allocatable :: weights(:)          !< (n_weights) N_i(xi) [-]
    real(DP), allocatable :: d_weights(:, :)     !< (2, n_weights) dN_i/dxi [-]
    real(DP) :: n(3) = 0                         !< unit normal [-]
    real(DP) :: d_gap_slave(3) = 0               !< dg/dx_s [-]
    real(DP), allocatable :: d_gap(:, :)         !< (3, n_nodes) dg/dx_j [-]
    real(DP) :: d_xi_slave(2, 3) = 0             !< dxi/dx_s [1/length]
    real(DP), allocatable :: d_xi(:, :, :)       !< (2, 3, n_nodes) dxi/dx_j [1/length]
    real(DP) :: d_n_slave(3, 3) = 0              !< dn/dx_s [1/length]
    real(DP), allocatable :: d_n(:, :, :)        !< (3, 3, n_nodes) dn/dx_j; first index: component of n [1/length]
  end type gap_derivative_type

end module amontons_places
