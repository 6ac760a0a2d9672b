!> Failure codes: why an attempt at an increment failed, with node labels and numbers. Other modules write the text.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The program decides by code and family only. `failure_report` finds the code and writes the text.
module amontons_failure
  use amontons_kinds, only: DP
  implicit none
  private
  public :: failure_type, family_of
  public :: FAILURE_NONE, FAILURE_MATERIAL, FAILURE_SINGULAR, FAILURE_NOT_FINITE, FAILURE_CONSTRAINTS, FAILURE_FREE_PUSHED, &
    FAILURE_FREE_FLYING, FAILURE_FREE_OPEN, FAILURE_FREE_MOTION, FAILURE_LEFT_MASTER, FAILURE_CYCLE, FAILURE_FLIP, &
    FAILURE_UNSETTLED, FAILURE_PASSED_THROUGH, FAILURE_DEEP, FAILURE_LIMIT_POINT, FAILURE_CONTACT_LIMIT, FAILURE_GROWING, &
    FAILURE_SLOW, FAILURE_USER_ROUTINE, FAILURE_SIGNAL, FAILURE_CROSSING, FAILURE_CREEP, N_FAILURES
  public :: FAMILY_NONE, FAMILY_MATERIAL, FAMILY_SOLVER, FAMILY_CONSTRAINTS, FAMILY_FREE_BODY, FAMILY_LEFT_MASTER, FAMILY_CYCLE, &
    FAMILY_FLIP, FAMILY_UNSETTLED, FAMILY_PENETRATION, FAMILY_LIMIT_POINT, FAMILY_SLOW, FAMILY_USER_ROUTINE, FAMILY_SIGNAL, &
    FAMILY_CREEP

  integer, parameter :: FAILURE_NONE = 0
  integer, parameter :: FAILURE_MATERIAL = 1       !< labels: the inverted element, or the element whose material update failed
  integer, parameter :: FAILURE_SINGULAR = 2       !< the tangent is singular
  integer, parameter :: FAILURE_NOT_FINITE = 3     !< a force is not finite
  integer, parameter :: FAILURE_CONSTRAINTS = 4    !< detail: the constraints in conflict in the current configuration
  integer, parameter :: FAILURE_FREE_PUSHED = 5    !< unsupported body without equilibrium; labels: its farthest node
  integer, parameter :: FAILURE_FREE_FLYING = 6    !< a body moves by many times the size of the model; labels: its farthest node
  integer, parameter :: FAILURE_FREE_OPEN = 7      !< an unsupported body, and no slave node is closed
  integer, parameter :: FAILURE_FREE_MOTION = 8    !< detail: the rigid body motion that supports and closed contact leave free
  integer, parameter :: FAILURE_LEFT_MASTER = 9    !< labels: slave nodes that left their master surface
  integer, parameter :: FAILURE_CYCLE = 10         !< active-set cycling; length, labels: slave nodes that cycle
  integer, parameter :: FAILURE_FLIP = 11          !< the same where only stick and slip alternate
  integer, parameter :: FAILURE_UNSETTLED = 12     !< labels: slave nodes whose status or facet still changes
  integer, parameter :: FAILURE_PASSED_THROUGH = 13   !< labels: the slave node that passed through its master (tunnelling)
  integer, parameter :: FAILURE_DEEP = 14          !< labels: slave nodes with a sudden deep penetration
  integer, parameter :: FAILURE_LIMIT_POINT = 15   !< the stiffness is not positive
  integer, parameter :: FAILURE_CONTACT_LIMIT = 16   !< no contact equilibrium nearby; labels: closed nodes of largest residual
  integer, parameter :: FAILURE_GROWING = 17       !< the residual grows from iteration to iteration
  integer, parameter :: FAILURE_SLOW = 18          !< the residual no longer decreases
  integer, parameter :: FAILURE_USER_ROUTINE = 19  !< number: PNEWDT returned by a user routine
  integer, parameter :: FAILURE_SIGNAL = 20        !< a signal stopped the job
  integer, parameter :: FAILURE_CROSSING = 21      !< detail: two bodies that passed through each other
  integer, parameter :: FAILURE_CREEP = 22         !< CETOL; labels: the element, number: what was found over what it allows
  integer, parameter :: N_FAILURES = 22

  integer, parameter :: FAMILY_NONE = 0, FAMILY_MATERIAL = 1, FAMILY_SOLVER = 2, FAMILY_CONSTRAINTS = 3, FAMILY_FREE_BODY = 4, &
    FAMILY_LEFT_MASTER = 5, FAMILY_CYCLE = 6, FAMILY_FLIP = 7, FAMILY_UNSETTLED = 8, FAMILY_PENETRATION = 9, &
    FAMILY_LIMIT_POINT = 10, FAMILY_SLOW = 11, FAMILY_USER_ROUTINE = 12, FAMILY_SIGNAL = 13, FAMILY_CREEP = 14

  integer, parameter :: FAMILIES(0:N_FAILURES) = [FAMILY_NONE, FAMILY_MATERIAL, FAMILY_SOLVER, FAMILY_SOLVER, FAMILY_CONSTRAINTS, &
    FAMILY_FREE_BODY, FAMILY_FREE_BODY, FAMILY_FREE_BODY, FAMILY_FREE_BODY, FAMILY_LEFT_MASTER, FAMILY_CYCLE, FAMILY_FLIP, &
    FAMILY_UNSETTLED, FAMILY_PENETRATION, FAMILY_PENETRATION, FAMILY_LIMIT_POINT, FAMILY_LIMIT_POINT, FAMILY_SLOW, FAMILY_SLOW, &
    FAMILY_USER_ROUTINE, FAMILY_SIGNAL, FAMILY_PENETRATION, FAMILY_CREEP]   !< of each code

  !> Why an attempt failed.
  type :: failure_type
    integer :: code = FAILURE_NONE                 !< FAILURE_...
    integer, allocatable :: labels(:)              !< of nodes, or of the element of FAILURE_MATERIAL
    integer :: length = 0                          !< of a cycle [iterations]
    integer :: n_slipping = 0                      !< closed slave nodes if all of them slip and there is more than one, else 0
    real(DP) :: number = 0                         !< PNEWDT of FAILURE_USER_ROUTINE, excess of FAILURE_CREEP [-]
    character(:), allocatable :: detail            !< text from the place of detection; for output only, never parsed
  end type failure_type

contains

  !> The family of a failure code.
  elemental integer function family_of(failure) result(family)
    type(failure_type), intent(in) :: failure
    family = FAMILIES(failure%code)
  end function family_of

end module amontons_failure
