!> The clock of a job: elapsed time and growth of the memory peak by phase.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_phase_clock
  use amontons_kinds, only: DP, I64
  use amontons_posix, only: peak_megabytes
  use amontons_iteration_records, only: N_PHASES
  implicit none
  private
  public :: phase_clock_type

  !> Each reading assigns all since the reading before to one phase: phases do not overlap and leave no gap.
  type :: phase_clock_type
    real(DP) :: seconds(N_PHASES) = 0              !< since the last collection [s]
    real(DP) :: megabytes(N_PHASES) = 0            !< growth of the memory peak since the last collection
    integer(I64), private :: last = 0              !< time of the last reading
    real(DP), private :: peak = 0                  !< memory peak at the last reading [megabytes]
  contains
    procedure :: start
    procedure :: read
    procedure :: collect
  end type phase_clock_type

contains

  !> Starts the clock.
  subroutine start(self)
    class(phase_clock_type), intent(inout) :: self
    self%seconds = 0.0_DP
    self%megabytes = 0.0_DP
    self%peak = 0.0_DP
    call system_clock(self%last)
  end subroutine start


  !> Adds the time and the growth of the memory peak since the last reading to a phase.
  subroutine read(self, phase)
    class(phase_clock_type), intent(inout) :: self
    integer, intent(in) :: phase                   !< PHASE_...
    integer(I64) :: now, rate
    real(DP) :: peak
    call system_clock(now, rate)
    peak = peak_megabytes()
    self%seconds(phase) = self%seconds(phase) + real(now - self%last, DP) / real(rate, DP)
    self%megabytes(phase) = self%megabytes(phase) + peak - self%peak
    self%last = now
    self%peak = peak
  end subroutine read


  !> Moves what was read to the sums of a record.
  subroutine collect(self, seconds, megabytes)
    class(phase_clock_type), intent(inout) :: self
    real(DP), intent(inout) :: seconds(:)          !< (N_PHASES) [s]
    real(DP), intent(inout) :: megabytes(:)        !< (N_PHASES)
    seconds = seconds + self%seconds
    megabytes = megabytes + self%megabytes
    self%seconds = 0.0_DP
    self%megabytes = 0.0_DP
  end subroutine collect

end module amontons_phase_clock
