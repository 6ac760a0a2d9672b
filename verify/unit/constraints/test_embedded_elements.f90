!> Unit test of amontons_embedded_elements: the equations of embedded nodes, weights that are left out, nodes that hosts share,
!! and nodes outside.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_embedded_elements
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_embedded_elements, only: embed_elements
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_loads, only: equation_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: START = '*NODE,NSET=ALL;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;' // &
    '11,.25,.5,.5;12,.75,.5,0;*ELEMENT,TYPE=C3D8,ELSET=E;1,1,2,3,4,5,6,7,8;*MATERIAL,NAME=M;*ELASTIC;100.,.3;' // &
    '*SOLID SECTION,ELSET=E,MATERIAL=M;'
  character(*), parameter :: BAR = '*ELEMENT,TYPE=T3D2,ELSET=BAR;11,11,12;*SOLID SECTION,ELSET=BAR,MATERIAL=M;.1;'
  character(*), parameter :: STEP = '*STEP;*STATIC;*END STEP;'
  type(suite_type) :: suite

  call check_equations()
  call check_shared_nodes()
  call check_outside()
  call suite%finish()

contains

  !> The equations of a deck, and what is said of nodes outside; error: its text, '' without.
  subroutine embed(cards, equations, text, error_text)
    character(*), intent(in) :: cards
    type(equation_type), allocatable, intent(out) :: equations(:)
    character(:), allocatable, intent(out) :: text, error_text
    type(model_type) :: model
    type(job_options_type) :: options
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    options%dialect = DIALECT_ABAQUS
    call read_deck_text(deck_lines(START // cards // STEP), options, model, diagnostics, error)
    call suite%that('read', .not. allocated(error))
    call embed_elements(model, equations, text, error)
    error_text = ''
    if (allocated(error)) error_text = error%message
  end subroutine embed


  !> Node 11 within the host has eight weights, node 12 on its face four.
  subroutine check_equations()
    type(equation_type), allocatable :: equations(:)
    character(:), allocatable :: text, error_text
    integer :: i
    call embed(BAR // '*EMBEDDED ELEMENT,HOST ELSET=E;BAR;', equations, text, error_text)
    call suite%that('nothing is outside', text == '' .and. error_text == '')
    call suite%that('three equations of each node', size(equations) == 6)
    if (size(equations) /= 6) return
    do i = 1, 6
      associate (equation => equations(i))
        call suite%that('its direction', all(equation%dof == 1 + modulo(i - 1, 3)))
        call suite%that('the node first', equation%node(1) == merge(9, 10, i <= 3) .and. abs(equation%coefficient(1) - 1) <= 0)
        call suite%that('nodes of the host', size(equation%node) == merge(9, 5, i <= 3))
        call suite%near('weights sum to 1', sum(equation%coefficient(2:)), -1.0_DP, 1e-14_DP)
      end associate
    end do
    associate (equation => equations(1))
      do i = 2, 9
        call suite%near('trilinear', equation%coefficient(i), -merge(0.1875_DP, 0.0625_DP, any(equation%node(i) == [1, 4, 5, 8])), &
          1e-12_DP)
      end do
    end associate
    call embed(BAR // '*EMBEDDED ELEMENT,ROUNDOFF TOLERANCE=.1;BAR;', equations, text, error_text)
    call suite%that('small weights are left out', size(equations(1)%node) == 5)
    call suite%near('the others still sum to 1', sum(equations(1)%coefficient(2:)), -1.0_DP, 1e-14_DP)
  end subroutine check_equations


  !> A bar that ends at a node of its host has no equation there.
  subroutine check_shared_nodes()
    type(equation_type), allocatable :: equations(:)
    character(:), allocatable :: text, error_text
    call embed('*ELEMENT,TYPE=T3D2,ELSET=BAR;11,1,11;*SOLID SECTION,ELSET=BAR,MATERIAL=M;.1;*EMBEDDED ELEMENT;11,;', &
      equations, text, error_text)
    call suite%that('one node', error_text == '' .and. size(equations) == 3 .and. equations(1)%node(1) == 9)
  end subroutine check_shared_nodes


  !> A node 0.04 outside moves with the nearest point, one 0.2 outside is an error.
  subroutine check_outside()
    type(equation_type), allocatable :: equations(:)
    character(:), allocatable :: text, error_text
    character(*), parameter :: REST = '*ELEMENT,TYPE=T3D2,ELSET=BAR;11,11,13;*SOLID SECTION,ELSET=BAR,MATERIAL=M;.1;' // &
      '*EMBEDDED ELEMENT;BAR;'
    call embed('*NODE;13,.5,.5,1.04;' // REST, equations, text, error_text)
    call suite%that(text, index(text, '1 node moves with the nearest point') > 0 .and. error_text == '')
    call suite%that('four nodes of the face', size(equations(4)%node) == 5)
    call embed('*NODE;13,.5,.5,1.2;' // REST, equations, text, error_text)
    call suite%that(error_text, index(error_text, '1 node of the embedded elements lies outside') > 0 .and. &
      index(error_text, 'node 13') > 0)
  end subroutine check_outside

end program test_embedded_elements
