!> Unit test of unpaired_crossing: bodies that passed through each other without a pair, by their edges or on their paths.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_unpaired_crossing
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type
  use amontons_unpaired_contact, only: model_faces_type
  use amontons_unpaired_crossing, only: find_unpaired_crossing
  use amontons_state, only: slave_state_type
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  type(suite_type) :: suite
  call move_up('not yet there', 0.0_DP, [0.0_DP, -1.9_DP], .false., '')
  call move_up('it touches', 0.0_DP, [0.0_DP, -2.0_DP], .false., '')
  call move_up('into the other one', 0.0_DP, [0.0_DP, -2.3_DP], .true., '')
  call move_up('into the other one, a pair has both faces', 0.0_DP, [0.0_DP, -2.3_DP], .false., '*CONTACT EXCLUSIONS;S_UP, S_LOW;')
  call move_up('right through', 0.0_DP, [0.0_DP, -9.0_DP], .true., '')
  call move_up('past it', 0.0_DP, [30.0_DP, -9.0_DP], .false., '')
  call move_up('they cross at the start', -2.5_DP, [0.0_DP, -0.3_DP], .false., '')
  call suite%finish()

contains

  !> A square two above another one that is twice as wide, moved in one increment.
  subroutine move_up(title, lift, way, is_found, cards)
    character(*), intent(in) :: title
    real(DP), intent(in) :: lift                 !< of the upper square at the start [length]
    real(DP), intent(in) :: way(2)               !< [length]
    logical, intent(in) :: is_found
    character(*), intent(in) :: cards
    type(model_type) :: model
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    type(job_options_type) :: options
    type(model_faces_type) :: faces
    character(:), allocatable :: message
    type(slave_state_type) :: slaves(0)
    real(DP) :: u(3, 8)
    integer :: turn
    call read_deck_text(deck_lines('*NODE;1,-0.5,0.;2,1.5,0.;3,1.5,1.;4,-0.5,1.;5,0.,3.;6,1.,3.;7,1.,4.;8,0.,4.;' // &
      '*ELEMENT, TYPE=CPE4, ELSET=LOW;1,1,2,3,4;*ELEMENT, TYPE=CPE4, ELSET=UP;2,5,6,7,8;*MATERIAL, NAME=M;*ELASTIC;100.,0.3;' // &
      '*SOLID SECTION, ELSET=LOW, MATERIAL=M;*SOLID SECTION, ELSET=UP, MATERIAL=M;*SURFACE, NAME=S_UP;UP, S1;UP, S2;UP, S4;' // &
      '*SURFACE, NAME=S_LOW;LOW, S3;*CONTACT;*CONTACT INCLUSIONS, ALL EXTERIOR;' // cards // &
      '*STEP, NLGEOM;*STATIC;*BOUNDARY;1,1,2;2,2;5,1;5,2,2,-0.5;6,2,2,-0.5;*END STEP;'), options, model, diagnostics, error)
    call suite%that(title // ': deck', .not. allocated(error))
    if (allocated(error)) return
    model%mesh%coordinates(2, 5:8) = model%mesh%coordinates(2, 5:8) + lift
    u = 0
    u(1, 5:8) = way(1)
    u(2, 5:8) = way(2)
    do turn = 1, 2                               ! nothing moved since: it is not looked for again
      call find_unpaired_crossing(model, faces, slaves, u, merge(1.0_DP, 0.0_DP, turn == 1) * u, 1, message)
      call suite%that(title, (is_found .and. turn == 1) .eqv. index(message, 'passed through element') > 0)
    end do
  end subroutine move_up

end program test_unpaired_crossing
